// Areas of an S7-200 and their notation. Independent of the bridge's tables.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "tools/sim/device/device.hpp"
#include "tools/sim/device/item_memory.hpp"

namespace fieldcast::sim {

inline constexpr std::array<std::string_view, 11> kPpiAreaNames{"V",  "M",  "I", "Q", "S", "SM",
                                                                "AI", "AQ", "T", "C", "HC"};

struct PpiArea {
  std::uint8_t code;     // in an item
  unsigned bits;         // of one variable
  std::uint32_t items;   // of a CPU 226
  bool counted;          // addressed by number; the transport equals the code
  std::uint32_t locked;  // number of leading read-only variables
};
inline constexpr std::array<PpiArea, 11> kPpiAreas{{
    {0x84, 8, 10240, false, 0},
    {0x83, 8, 32, false, 0},
    {0x81, 8, 16, false, 16},  // can only be forced
    {0x82, 8, 16, false, 0},
    {0x04, 8, 32, false, 32},
    {0x05, 8, 550, false, 30},
    {0x06, 16, 32, false, 32},
    {0x07, 16, 32, false, 0},
    {0x1F, 32, 256, true, 256},
    {0x1E, 16, 256, true, 256},
    {0x20, 32, 6, true, 6},
}};
[[nodiscard]] std::vector<ItemArea> ppi_areas();

// "VB100", "VW100", "VD204", "V10.3", "SMB28", "AIW4", "T37".
[[nodiscard]] std::optional<ItemAddress> parse_ppi_address(std::string_view at);

// A simulated S7-200 on the level of S7 messages: a job in, an acknowledgement with data out. Does
// not own the memory.
//
//     job    32 01 0000 reference(2) parameters(2) data(2) ..
//            the parameters: 04|05 n, then items of 12 bytes
//     ack    32 03 0000 reference(2) parameters(2) data(2) error(2) ..
class PpiUnit {
 public:
  PpiUnit(ItemMemory& memory, DeviceStatistics& statistics)
      : memory_(memory), statistics_(statistics) {}

  // Responds to a job of any content; empty if its lengths contradict each other.
  [[nodiscard]] Bytes execute(ByteView job, Instant now);

 private:
  struct Item {
    std::size_t area = 0;
    std::uint32_t first = 0, count = 0;  // in variables of the area
    std::optional<std::uint8_t> bit;
    std::uint8_t fault = 0;
  };
  [[nodiscard]] Item item_of(ByteView item) const;
  [[nodiscard]] std::uint8_t fault_of(const Item& item) const;
  [[nodiscard]] Bytes read(ByteView reference, ByteView items, Instant now);
  [[nodiscard]] Bytes write(ByteView reference, ByteView items, ByteView data, Instant now);
  [[nodiscard]] std::uint8_t store(const Item& item, std::uint8_t transport, std::uint16_t length,
                                   ByteView value, Instant now);
  [[nodiscard]] Bytes value_of(const Item& item, Instant now) const;
  [[nodiscard]] Bytes refuse(ByteView reference, std::uint16_t error);
  std::uint8_t counted(std::uint8_t fault);

  ItemMemory& memory_;
  DeviceStatistics& statistics_;
};

}  // namespace fieldcast::sim
