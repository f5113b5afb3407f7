// A simulated Modbus device on the level of PDUs. Implemented from the Application Protocol V1.1b3
// only, independent of the bridge's Modbus. Does not own the device's memory.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "tools/sim/device/item_memory.hpp"

namespace fieldcast::sim {

inline constexpr std::size_t kMaxPdu = 253;  // V1.1b3, 4.1

struct ModbusArea {
  enum : std::size_t { kCoil, kInput, kHolding, kInputRegister, kFile, kIdentity, kFifo };
};
inline constexpr std::array<std::string_view, 7> kModbusAreaNames{
    "coil", "input", "holding", "input-register", "file", "id", "fifo"};
[[nodiscard]] std::vector<ItemArea> modbus_areas();

// "holding:107", "holding:107.3", "40108", "file:4:7", "id:0", "fifo:1246", "fifo:1246:1";
// independent of the bridge's parser.
[[nodiscard]] std::optional<ItemAddress> parse_modbus_address(std::string_view at);

class ModbusUnit {
 public:
  ModbusUnit(std::uint8_t address, ItemMemory& memory, DeviceStatistics& statistics)
      : address_(address), memory_(memory), statistics_(statistics) {
    identify_as({"Fieldcast", "simulated device", "1.0"});
  }

  [[nodiscard]] std::uint8_t address() const { return address_; }
  [[nodiscard]] DeviceStatistics& statistics() { return statistics_; }
  // Writes the first objects of function 43/14: vendor, product code, revision. Conformity above 80
  // hexadecimal: each object can also be read alone.
  void identify_as(const std::vector<std::string>& objects, std::uint8_t conformity = 0x83);

  // Accepts any bytes. Returns the response or an exception; empty only for an empty request.
  [[nodiscard]] Bytes execute(ByteView pdu, Instant now);

 private:
  enum Exception : std::uint8_t { kFunction = 1, kAddress, kValue };
  struct Items {
    std::size_t area = 0;
    std::uint32_t first = 0, count = 1;
  };
  [[nodiscard]] Bytes dispatch(ByteView pdu, Instant now);
  [[nodiscard]] Bytes read(std::size_t area, ByteView pdu, Instant now);
  [[nodiscard]] Bytes write_coil(ByteView pdu);
  [[nodiscard]] Bytes write_register(ByteView pdu);
  [[nodiscard]] Bytes write_many(std::size_t area, ByteView pdu);
  [[nodiscard]] Bytes mask_write(ByteView pdu, Instant now);
  [[nodiscard]] Bytes write_read(ByteView pdu, Instant now);
  [[nodiscard]] Bytes exception_status(ByteView pdu, Instant now);
  [[nodiscard]] Bytes diagnostics(ByteView pdu);
  [[nodiscard]] Bytes read_file(ByteView pdu, Instant now);
  [[nodiscard]] Bytes write_file(ByteView pdu);
  [[nodiscard]] Bytes read_fifo(ByteView pdu, Instant now);
  [[nodiscard]] Bytes identification(ByteView pdu, Instant now);
  [[nodiscard]] std::optional<std::string> object(unsigned id, Instant now) const;

  Bytes exception(ByteView pdu, std::uint8_t code);
  [[nodiscard]] std::uint8_t refusal(const Items& items) const {
    return memory_.refusal(items.area, items.first, items.count, kAddress);
  }
  [[nodiscard]] std::uint16_t value(const Items& items, std::uint32_t index, Instant now) const {
    return static_cast<std::uint16_t>(memory_.read(items.area, items.first + index, now));
  }
  [[nodiscard]] Bytes registers(std::uint8_t function, const Items& items, Instant now) const;
  // `data`: packed bits or registers.
  void store(const Items& items, ByteView data);

  const std::uint8_t address_;
  ItemMemory& memory_;
  DeviceStatistics& statistics_;
  std::uint8_t conformity_ = 0;
};

}  // namespace fieldcast::sim
