#include "tools/sim/families/modbus/modbus_memory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "tools/sim/device/waveform.hpp"
#include "tools/sim/families/modbus/modbus_receivers.hpp"

namespace fieldcast::sim {

namespace {

// Decimal, or hexadecimal with the prefix 0x.
std::optional<std::uint32_t> number(std::string_view text, std::uint32_t limit) {
  std::uint32_t value = 0;
  const bool hex = text.starts_with("0x") || text.starts_with("0X");
  if (hex) text.remove_prefix(2);
  const auto [end, error] =
      std::from_chars(text.data(), text.data() + text.size(), value, hex ? 16 : 10);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size() || value > limit)
    return std::nullopt;
  return value;
}

}  // namespace

std::optional<ModbusAddress> parse_modbus_address(std::string_view at) {
  ModbusAddress address;
  if (const auto dot = at.rfind('.'); dot != std::string_view::npos) {
    const auto bit = number(at.substr(dot + 1), 15);
    if (!bit) return std::nullopt;
    address.bit = static_cast<std::uint8_t>(*bit);
    at = at.substr(0, dot);
  }
  if (const auto colon = at.find(':'); colon != std::string_view::npos) {
    const std::string_view word = at.substr(0, colon);
    const auto name = std::ranges::find(
        kModbusAreaNames, word == "discrete-input" ? to_text(ModbusArea::kInput) : word);
    const auto first = number(at.substr(colon + 1), ModbusMemory::kItems - 1);
    if (name == kModbusAreaNames.end() || !first) return std::nullopt;
    address.area = static_cast<ModbusArea>(name - kModbusAreaNames.begin());
    address.first = static_cast<std::uint16_t>(*first);
    return address;
  }
  // Classic reference numbers: area digit, then a number from 1; six digits for all 65536 items.
  if (at.size() != 5 && at.size() != 6) return std::nullopt;
  const auto rest = number(at.substr(1), ModbusMemory::kItems);
  if (!rest || *rest == 0) return std::nullopt;
  switch (at[0]) {
    case '0': address.area = ModbusArea::kCoil; break;
    case '1': address.area = ModbusArea::kInput; break;
    case '3': address.area = ModbusArea::kInputRegister; break;
    case '4': address.area = ModbusArea::kHolding; break;
    default: return std::nullopt;
  }
  address.first = static_cast<std::uint16_t>(*rest - 1);
  return address;
}

bool ModbusMemory::add_channel(const ModbusAddress& at, const Encoding& encoding,
                               const Waveform& waveform) {
  const std::uint32_t count = is_bits(at.area) ? 1u : waveform_registers(encoding);
  if (at.first + count > kItems || (is_bits(at.area) && encoding.type != ValueType::kBool))
    return false;
  Cells& cells = cells_[static_cast<std::size_t>(at.area)];
  const auto position =
      std::ranges::upper_bound(cells.live, std::uint32_t{at.first}, {}, &Live::first);
  cells.live.insert(position,
                    Live{at.first, count, at.bit ? at.bit : encoding.bit, encoding, waveform});
  cells.longest = std::max(cells.longest, count);
  return true;
}

void ModbusMemory::refresh(Cells& cells, ModbusArea area, std::uint32_t first, std::uint32_t count,
                           Instant now) {
  const std::uint32_t from = first >= cells.longest ? first - cells.longest : 0;
  for (auto live = std::ranges::lower_bound(cells.live, from, {}, &Live::first);
       live != cells.live.end() && live->first < first + count; ++live) {
    bool held = false;
    for (std::uint32_t i = 0; i < live->count; ++i) held = held || cells.held[live->first + i];
    if (held || live->first + live->count <= first) continue;
    const auto items = waveform_items(live->waveform, live->encoding, now - start_);
    if (is_bits(area) || !live->bit) {
      std::ranges::copy(items, cells.values.begin() + live->first);
    } else {
      std::uint16_t& word = cells.values[live->first];
      const unsigned ones = (1u << waveform_bits(live->encoding)) - 1;
      const unsigned own = live->encoding.type == ValueType::kBool ? items[0] != 0 : items[0];
      word =
          static_cast<std::uint16_t>((word & ~(ones << *live->bit)) | (own & ones) << *live->bit);
    }
  }
}

std::vector<std::uint16_t> ModbusMemory::read(ModbusArea area, std::uint32_t first,
                                              std::uint32_t count, Instant now) {
  Cells& cells = cells_[static_cast<std::size_t>(area)];
  refresh(cells, area, first, count, now);
  return {cells.values.begin() + first, cells.values.begin() + first + count};
}

void ModbusMemory::preset(ModbusArea area, std::uint32_t first,
                          const std::vector<std::uint16_t>& values) {
  Cells& cells = cells_[static_cast<std::size_t>(area)];
  for (std::size_t i = 0; i < values.size(); ++i) {
    cells.values[first + i] = values[i];
    cells.held[first + i] = true;
  }
}

void ModbusMemory::write(ModbusArea area, std::uint32_t first,
                         const std::vector<std::uint16_t>& values) {
  preset(area, first, values);
}

bool ModbusMemory::configured(ModbusArea area, std::uint32_t item) const {
  const Cells& cells = cells_[static_cast<std::size_t>(area)];
  const std::uint32_t from = item >= cells.longest ? item - cells.longest : 0;
  for (auto live = std::ranges::lower_bound(cells.live, from, {}, &Live::first);
       live != cells.live.end() && live->first <= item; ++live) {
    if (item < live->first + live->count) return true;
  }
  return false;
}

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
