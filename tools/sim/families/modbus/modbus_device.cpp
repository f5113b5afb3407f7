#include "tools/sim/families/modbus/modbus_device.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tools/sim/device/waveform.hpp"
#include "tools/sim/families/modbus/modbus_receivers.hpp"

namespace fieldcast::sim {
namespace {

enum class Framing : std::uint8_t { kRtu, kAscii, kTcp };

class ModbusDevice : public SimDevice {
 public:
  ModbusDevice(const DeviceSetup& setup, Framing framing)
      : unit_(static_cast<std::uint8_t>(setup.spec.link.address), setup.start),
        line_(setup.line),
        framing_(framing),
        stream_(setup.stream),
        any_unit_(setup.first_on_bus) {
    unit_.refuse(setup.refused);
    if (setup.only_configured) unit_.refuse_unconfigured();
  }

  [[nodiscard]] std::unique_ptr<Receiver> open_receiver() override {
    switch (framing_) {
      case Framing::kRtu: return std::make_unique<RtuReceiver>(unit_, line_, stream_);
      case Framing::kAscii: return std::make_unique<AsciiReceiver>(unit_);
      case Framing::kTcp: break;
    }
    return std::make_unique<TcpReceiver>(unit_, any_unit_);
  }
  [[nodiscard]] const DeviceStatistics& statistics() const override { return unit_.statistics(); }
  [[nodiscard]] std::optional<std::uint64_t> peek(std::string_view area, std::uint32_t item,
                                                  Instant now) override {
    const auto found = area_named(area);
    if (!found || item >= ModbusMemory::kItems) return std::nullopt;
    return unit_.memory().read(*found, item, 1, now)[0];
  }
  bool poke(std::string_view area, std::uint32_t item, std::uint64_t bits) override {
    const auto found = area_named(area);
    if (!found || item >= ModbusMemory::kItems) return false;
    unit_.memory().preset(*found, item, {static_cast<std::uint16_t>(bits)});
    return true;
  }
  [[nodiscard]] ModbusUnit& unit() { return unit_; }

 private:
  static std::optional<ModbusArea> area_named(std::string_view name) {
    const auto found = std::ranges::find(kModbusAreaNames, name);
    if (found == kModbusAreaNames.end()) return std::nullopt;
    return static_cast<ModbusArea>(found - kModbusAreaNames.begin());
  }
  ModbusUnit unit_;
  LineFormat line_;
  Framing framing_;
  bool stream_;
  bool any_unit_;
};

tl::expected<std::unique_ptr<SimDevice>, std::string> make(const DeviceSetup& setup,
                                                           Framing framing) {
  const DeviceSpec& spec = setup.spec;
  const bool tcp = framing == Framing::kTcp;
  if (spec.link.address > 255 || (!tcp && (spec.link.address < 1 || spec.link.address > 247))) {
    return tl::unexpected(
        fmt::format("{}: unit {} is not a Modbus address", spec.name, spec.link.address));
  }
  auto device = std::make_unique<ModbusDevice>(setup, framing);
  for (const ChannelSpec& channel : spec.channels) {
    const auto at = parse_modbus_address(channel.at);
    const Waveform wave = waveform_for(channel, setup.seed);
    if (!at || !device->unit().memory().add_channel(*at, channel.encoding, wave)) {
      return tl::unexpected(fmt::format("{}/{}: '{}' is not an address for its type", spec.name,
                                        channel.name, channel.at));
    }
  }
  // After the channels: if a channel has the same register, the exponent's value wins.
  for (const ChannelSpec& channel : spec.channels) {
    if (channel.exponent_from.empty()) continue;
    const auto at = parse_modbus_address(channel.exponent_from);
    if (!at || !device->unit().memory().add_channel(*at, exponent_encoding(channel),
                                                    exponent_waveform())) {
      return tl::unexpected(fmt::format("{}/{}: '{}' is not an address of an exponent", spec.name,
                                        channel.name, channel.exponent_from));
    }
  }
  return device;
}

}  // namespace

tl::expected<std::unique_ptr<SimDevice>, std::string> make_modbus_rtu_device(
    const DeviceSetup& setup) {
  return make(setup, Framing::kRtu);
}
tl::expected<std::unique_ptr<SimDevice>, std::string> make_modbus_ascii_device(
    const DeviceSetup& setup) {
  return make(setup, Framing::kAscii);
}
tl::expected<std::unique_ptr<SimDevice>, std::string> make_modbus_tcp_device(
    const DeviceSetup& setup) {
  return make(setup, Framing::kTcp);
}

}  // namespace fieldcast::sim
