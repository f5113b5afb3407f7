// A simulated S7-200 on the level of S7 messages: a job in, an acknowledgement with data out.
//
//     job    32 01 0000 reference(2) parameters(2) data(2) ..
//            the parameters: 04|05 n, then items of 12 bytes
//     ack    32 03 0000 reference(2) parameters(2) data(2) error(2) ..
#pragma once

#include "tools/sim/device/device.hpp"
#include "tools/sim/families/ppi_memory.hpp"

namespace fieldcast::sim {

class PpiUnit {
 public:
  explicit PpiUnit(const DeviceSetup& setup) : memory_(ppi_areas(), setup) {}

  [[nodiscard]] ItemMemory& memory() { return memory_; }
  [[nodiscard]] const DeviceStatistics& statistics() const { return statistics_; }

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

  ItemMemory memory_;
  DeviceStatistics statistics_;
};

}  // namespace fieldcast::sim
