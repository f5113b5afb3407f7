#include "tools/sim/families/modbus/modbus_device.hpp"

#include <fmt/format.h>

#include "tools/sim/families/modbus/modbus_receivers.hpp"

namespace fieldcast::sim {

namespace {

enum class Framing : std::uint8_t { kRtu, kAscii, kTcp };

class ModbusDevice : public MemoryDevice {
 public:
  ModbusDevice(const DeviceSetup& setup, Framing framing)
      : MemoryDevice({modbus_areas(), setup}),
        unit_(static_cast<std::uint8_t>(setup.spec.link.address), memory_, statistics_),
        line_(setup.line),
        framing_(framing),
        stream_(setup.stream),
        any_unit_(setup.first_on_bus) {}

  [[nodiscard]] std::unique_ptr<Receiver> open_receiver() override {
    switch (framing_) {
      case Framing::kRtu: return std::make_unique<RtuReceiver>(unit_, line_, stream_);
      case Framing::kAscii: return std::make_unique<AsciiReceiver>(unit_);
      case Framing::kTcp: break;
    }
    return std::make_unique<TcpReceiver>(unit_, any_unit_);
  }

 private:
  ModbusUnit unit_;
  LineFormat line_;
  Framing framing_;
  bool stream_;
  bool any_unit_;
};

tl::expected<std::unique_ptr<SimDevice>, std::string> make(const DeviceSetup& setup,
                                                           Framing framing) {
  const unsigned address = setup.spec.link.address;
  if (address > 255 || (framing != Framing::kTcp && (address < 1 || address > 247))) {
    return tl::unexpected(
        fmt::format("{}: unit {} is not a Modbus address", setup.spec.name, address));
  }
  auto device = std::make_unique<ModbusDevice>(setup, framing);
  if (auto added = device->memory().add_channels(setup, parse_modbus_address); !added)
    return tl::unexpected(added.error());
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
