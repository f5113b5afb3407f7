// Areas of S7 CPUs and their notation. Independent of the bridge's tables.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "tools/sim/device/device.hpp"
#include "tools/sim/device/item_memory.hpp"

namespace fieldcast::sim {

struct S7Area {
  std::string_view name;
  std::uint8_t code;        // in an item
  unsigned bits;            // of one variable
  std::uint32_t items;      // of the largest CPU
  std::uint32_t locked;     // number of leading read-only variables
  bool counted = false;     // addressed by number; the transport equals the code
  std::uint8_t status = 0;  // bytes before each value
  bool blocks = false;      // of all data blocks, from 1 on, kS7BlockBytes each
};
inline constexpr std::uint32_t kS7BlockBytes = 65536;

inline constexpr std::array<std::string_view, 11> kPpiAreaNames{"V",  "M",  "I", "Q", "S", "SM",
                                                                "AI", "AQ", "T", "C", "HC"};
inline constexpr std::array<std::string_view, 13> kS7TcpAreaNames{
    "DB", "V", "M", "I", "Q", "PI", "S", "SM", "AI", "AQ", "T", "C", "HC"};

inline constexpr std::array<S7Area, 11> kPpiAreas{{
    {"V", 0x84, 8, 10240, 0},
    {"M", 0x83, 8, 32, 0},
    {"I", 0x81, 8, 16, 16},  // can only be forced
    {"Q", 0x82, 8, 16, 0},
    {"S", 0x04, 8, 32, 32},
    {"SM", 0x05, 8, 550, 30},
    {"AI", 0x06, 16, 32, 32},
    {"AQ", 0x07, 16, 32, 0},
    {"T", 0x1F, 32, 256, 256, true, 1},
    {"C", 0x1E, 16, 256, 256, true, 1},
    {"HC", 0x20, 32, 6, 6, true, 1},
}};
// The S7-200 SMART has other sizes. What is locked as a whole stays so.
inline constexpr std::array<S7Area, 11> kS7SmartAreas = [] {
  constexpr std::array<std::uint32_t, 11> kSizes{20480, 32, 32, 32, 32, 1536, 56, 56, 256, 256, 6};
  auto areas = kPpiAreas;
  for (std::size_t i = 0; i < areas.size(); ++i) {
    if (areas[i].locked == areas[i].items) areas[i].locked = kSizes[i];
    areas[i].items = kSizes[i];
  }
  return areas;
}();
inline constexpr std::array<S7Area, 7> kS71500Areas{{
    {"DB", 0x84, 8, 65535 * kS7BlockBytes, 0, false, 0, true},
    {"M", 0x83, 8, 16384, 0},
    {"I", 0x81, 8, 32768, 32768},
    {"Q", 0x82, 8, 32768, 0},
    {"PI", 0x80, 8, 32768, 32768},
    {"T", 0x1D, 16, 2048, 2048, true},
    {"C", 0x1C, 16, 2048, 2048, true},
}};
[[nodiscard]] std::vector<ItemArea> s7_areas(std::span<const S7Area> areas);

// "VB100", "VW100", "VD204", "V10.3", "SMB28", "AIW4", "T37", "DB10.DBW20", "DB10.DBX20.3".
[[nodiscard]] std::optional<ItemAddress> parse_s7_address(std::span<const S7Area> areas,
                                                          std::string_view at);

// A simulated CPU on the level of S7 messages: a job in, an acknowledgement with data out. Does
// not own the memory.
//
//     job    32 01 0000 reference(2) parameters(2) data(2) ..
//            the parameters: 04|05 n, then items of 12 bytes
//     ack    32 03 0000 reference(2) parameters(2) data(2) error(2) ..
class S7Unit {
 public:
  // `most`: bytes of the longest message that the CPU grants.
  S7Unit(ItemMemory& memory, DeviceStatistics& statistics, std::span<const S7Area> areas,
         std::uint16_t most)
      : memory_(memory), statistics_(statistics), areas_(areas), most_(most) {}

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
  [[nodiscard]] static Item in_block(Item item, std::uint32_t block);
  [[nodiscard]] std::uint8_t fault_of(const Item& item) const;
  [[nodiscard]] Bytes read(ByteView reference, ByteView items, Instant now);
  [[nodiscard]] Bytes write(ByteView reference, ByteView items, ByteView data, Instant now);
  [[nodiscard]] std::uint8_t store(const Item& item, std::uint8_t transport, std::uint16_t length,
                                   ByteView value, Instant now);
  [[nodiscard]] Bytes value_of(const Item& item, Instant now) const;
  [[nodiscard]] Bytes status_list(ByteView request);
  [[nodiscard]] Bytes refuse(ByteView reference, std::uint16_t error);
  std::uint8_t counted(std::uint8_t fault);

  ItemMemory& memory_;
  DeviceStatistics& statistics_;
  const std::span<const S7Area> areas_;
  const std::uint16_t most_;
};

}  // namespace fieldcast::sim
