// A simulated Modbus device on the level of PDUs. Implemented from the Application Protocol V1.1b3
// only, independent of the bridge's Modbus.
#pragma once

#include <string>
#include <vector>

#include "tools/sim/device/device.hpp"
#include "tools/sim/families/modbus/modbus_memory.hpp"

namespace fieldcast::sim {

inline constexpr std::size_t kMaxPdu = 253;  // V1.1b3, 4.1

enum class ModbusException : std::uint8_t { kFunction = 1, kAddress = 2, kValue = 3 };

class ModbusUnit {
 public:
  ModbusUnit(std::uint8_t address, Instant start) : address_(address), memory_(start) {}

  [[nodiscard]] std::uint8_t address() const { return address_; }
  [[nodiscard]] ModbusMemory& memory() { return memory_; }
  [[nodiscard]] DeviceStatistics& statistics() { return statistics_; }
  [[nodiscard]] const DeviceStatistics& statistics() const { return statistics_; }

  void refuse(std::vector<RefusedRange> ranges) { refused_ = std::move(ranges); }
  void refuse_unconfigured() { only_configured_ = true; }
  // Objects of function 43/14: vendor, product code, revision; each at most 64 characters.
  void identify_as(std::vector<std::string> objects) { identification_ = std::move(objects); }

  // Accepts any bytes. Returns the response or an exception; empty only for an empty request.
  [[nodiscard]] Bytes execute(ByteView pdu, Instant now);

 private:
  [[nodiscard]] Bytes dispatch(ByteView pdu, Instant now);
  [[nodiscard]] Bytes read_bits(ModbusArea area, ByteView pdu, Instant now);
  [[nodiscard]] Bytes read_registers(ModbusArea area, ByteView pdu, Instant now);
  [[nodiscard]] Bytes write_coil(ByteView pdu);
  [[nodiscard]] Bytes write_register(ByteView pdu);
  [[nodiscard]] Bytes write_coils(ByteView pdu);
  [[nodiscard]] Bytes write_registers(ByteView pdu);
  [[nodiscard]] Bytes mask_write(ByteView pdu, Instant now);
  [[nodiscard]] Bytes write_read(ByteView pdu, Instant now);
  [[nodiscard]] Bytes exception_status(ByteView pdu, Instant now);
  [[nodiscard]] Bytes diagnostics(ByteView pdu);
  [[nodiscard]] Bytes identification(ByteView pdu);

  [[nodiscard]] Bytes exception(std::uint8_t function, std::uint8_t code);
  [[nodiscard]] Bytes exception(std::uint8_t function, ModbusException code) {
    return exception(function, static_cast<std::uint8_t>(code));
  }
  [[nodiscard]] std::uint8_t refusal(ModbusArea area, std::uint32_t first,
                                     std::uint32_t count) const;
  void store(ModbusArea area, std::uint32_t first, const std::vector<std::uint16_t>& values);

  std::uint8_t address_;
  ModbusMemory memory_;
  DeviceStatistics statistics_;
  std::vector<RefusedRange> refused_;
  bool only_configured_ = false;
  std::vector<std::string> identification_{"Fieldcast", "simulated device", "1.0"};
};

}  // namespace fieldcast::sim
