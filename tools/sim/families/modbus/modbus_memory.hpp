// Memory of a simulated Modbus device: four areas of 65536 items. Owned by one ModbusUnit.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/time.hpp"
#include "tools/sim/device/device.hpp"
#include "tools/sim/device/waveform.hpp"

namespace fieldcast::sim {

enum class ModbusArea : std::uint8_t { kCoil, kInput, kHolding, kInputRegister };
inline constexpr std::array<std::string_view, 4> kModbusAreaNames{"coil", "input", "holding",
                                                                  "input-register"};
[[nodiscard]] constexpr std::string_view to_text(ModbusArea area) {
  return kModbusAreaNames[static_cast<std::size_t>(area)];
}
[[nodiscard]] constexpr bool is_bits(ModbusArea area) {
  return area == ModbusArea::kCoil || area == ModbusArea::kInput;
}

// "holding:107", "holding:107.3", "40108"; independent of the bridge's parser.
struct ModbusAddress {
  ModbusArea area = ModbusArea::kHolding;
  std::uint16_t first = 0;
  std::optional<std::uint8_t> bit;
};
[[nodiscard]] std::optional<ModbusAddress> parse_modbus_address(std::string_view at);

class ModbusMemory {
 public:
  static constexpr std::uint32_t kItems = 65536;

  explicit ModbusMemory(Instant start) : start_(start) {}

  // The items follow the waveform until one of them is written. Returns false if it exceeds the
  // area.
  bool add_channel(const ModbusAddress& at, const Encoding& encoding, const Waveform& waveform);

  // Bits are 0 or 1. REQUIRES: first + count <= kItems.
  [[nodiscard]] std::vector<std::uint16_t> read(ModbusArea area, std::uint32_t first,
                                                std::uint32_t count, Instant now);
  // Write of a master.
  void write(ModbusArea area, std::uint32_t first, const std::vector<std::uint16_t>& values);
  // Write of the plant before the start: not counted.
  void preset(ModbusArea area, std::uint32_t first, const std::vector<std::uint16_t>& values);

  [[nodiscard]] bool configured(ModbusArea area, std::uint32_t item) const;

 private:
  struct Live {
    std::uint32_t first = 0, count = 0;
    std::optional<std::uint8_t> bit;
    Encoding encoding;
    Waveform waveform;
  };
  struct Cells {
    std::vector<std::uint16_t> values = std::vector<std::uint16_t>(kItems);
    std::vector<bool> held = std::vector<bool>(kItems);  // written or preset
    std::vector<Live> live;                              // sorted by `first`
    std::uint32_t longest = 0;
  };
  void refresh(Cells& cells, ModbusArea area, std::uint32_t first, std::uint32_t count,
               Instant now);

  Instant start_;
  std::array<Cells, 4> cells_;
};

// Simulated Modbus devices: a ModbusUnit with one of three framings.

// Each fails for a unit outside 1..247 (TCP: 0..255) or an invalid channel address.
[[nodiscard]] tl::expected<std::unique_ptr<SimDevice>, std::string> make_modbus_rtu_device(
    const DeviceSetup& setup);
[[nodiscard]] tl::expected<std::unique_ptr<SimDevice>, std::string> make_modbus_ascii_device(
    const DeviceSetup& setup);
[[nodiscard]] tl::expected<std::unique_ptr<SimDevice>, std::string> make_modbus_tcp_device(
    const DeviceSetup& setup);

}  // namespace fieldcast::sim
