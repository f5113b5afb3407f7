// Telegraf configuration: every [[inputs.modbus]] in its three styles. Addresses count from 0.
//
// Source: influxdata/telegraf plugins/inputs/modbus README.md and configuration_*.go (keys, data
// types, byte orders), up to 1.36 and from 1.37 on; grid-x/serial serial.go (baud, parity).
#include <fmt/format.h>

#include <algorithm>

#include "core/base/duration_text.hpp"
#include "tools/import/formats/format.hpp"
#include "tools/import/points/address.hpp"
#include "tools/import/points/names.hpp"
#include "tools/import/points/types.hpp"
#include "tools/import/text/text.hpp"
#include "tools/import/text/tree.hpp"

namespace fieldcast::importing {
namespace {

struct RegisterWord {
  std::string_view word;
  ModbusArea area;
};
// Lists of the style "register"; other styles use the values of `register`.
constexpr RegisterWord kRegisterLists[] = {{"coils", ModbusArea::kCoil},
                                           {"discrete_inputs", ModbusArea::kInput},
                                           {"input_registers", ModbusArea::kInputRegister},
                                           {"holding_registers", ModbusArea::kHolding}};
constexpr RegisterWord kRegisterWords[] = {{"coil", ModbusArea::kCoil},
                                           {"discrete", ModbusArea::kInput},
                                           {"input", ModbusArea::kInputRegister},
                                           {"holding", ModbusArea::kHolding}};

// Parses "1s", "500ms"; does not support "1m30s".
std::optional<Duration> go_duration(std::string_view text) {
  if (const auto plain = duration_from(text)) return plain;
  if (const auto seconds = number_from(text); seconds && *seconds >= 0 && *seconds < 1e6)
    return std::chrono::milliseconds{static_cast<std::int64_t>(*seconds * 1000)};
  return std::nullopt;
}

Port port_of_controller(const Node& plugin) {
  Port port;
  const std::string_view controller = text_at(plugin, "controller");
  if (const std::size_t scheme = controller.find("://");
      scheme != std::string_view::npos && !controller.starts_with("file")) {
    port.tcp = controller.substr(scheme + 3);
    return port;
  }
  port.serial = controller.starts_with("file://") ? controller.substr(7) : controller;
  if (const auto baud = whole_at(plugin, "baud_rate"); baud && *baud < 10'000'000)
    port.line.baud = static_cast<std::uint32_t>(*baud);
  const auto bits = whole_at(plugin, "data_bits").value_or(8);
  const auto stop = whole_at(plugin, "stop_bits").value_or(1);
  const std::string_view parity = text_at(plugin, "parity");
  // The default of Telegraf's serial library is 19200 8E1.
  port.line.format = fmt::format("{}{}{}", bits, parity.empty() ? 'E' : parity[0], stop);
  port.usual = {19200, "Telegraf"};
  return port;
}

std::string protocol_of(const Node& plugin, const Port& port) {
  const std::string mode = lower(text_at(plugin, "transmission_mode"));
  if (mode.starts_with("ascii")) return "modbus-ascii";
  if (mode.starts_with("rtu") || port.tcp.empty()) return "modbus-rtu";
  return "modbus-tcp";
}

class TelegrafReader {
 public:
  TelegrafReader(const SourceText& source, Found& found) : source_(source), found_(found) {}

  void read(const Node& root) {
    if (const Node* agent = child(root, "agent"))
      interval_ = go_duration(text_at(*agent, "interval"));
    const Node* inputs = child(root, "inputs");
    const Node* plugins = inputs == nullptr ? nullptr : child(*inputs, "modbus");
    if (is_map(plugins)) read_plugin(*plugins);
    if (is_list(plugins)) {
      for (const Node* plugin : plugins->items) read_plugin(*plugin);
    }
    other_keys_.tell(source_.file, found_);
  }

 private:
  using MayFail = std::optional<std::string>;

  struct FieldPlace {
    ModbusArea area = ModbusArea::kHolding;
    std::string_view byte_order, measurement;
    bool in_register_style = false;
  };

  void read_plugin(const Node& plugin) {
    other_keys_.look(
        plugin, "inputs.modbus",
        {"name", "controller", "baud_rate", "data_bits", "stop_bits", "parity", "transmission_mode",
         "interval", "timeout", "slave_id", "workarounds", "configuration_type", "coils",
         "discrete_inputs", "input_registers", "holding_registers", "request", "metric"});
    Bus bus;
    bus.origin = {source_.file, line_of(plugin)};
    if (const std::string_view controller = text_at(plugin, "controller");
        controller.starts_with("udp:"))
      bus.fault = fmt::format("its controller {}: a bus has no port of UDP", controller);
    bus.port = port_of_controller(plugin);
    bus.protocol = protocol_of(plugin, bus.port);
    strings_ = {};
    if (const Node* workarounds = child(plugin, "workarounds")) {
      other_keys_.look(*workarounds, "workarounds",
                       {"string_register_location", "pause_between_requests",
                        "max_word_registers_per_request", "one_request_per_field"});
      strings_ = text_at(*workarounds, "string_register_location");
    }
    refresh_ = go_duration(text_at(plugin, "interval"));
    if (!refresh_) refresh_ = interval_;
    const std::string_view name = text_at(plugin, "name");
    for (const RegisterWord& list : kRegisterLists) {
      const Node* fields = child(plugin, list.word);
      if (!is_list(fields)) continue;
      Device& device = device_of(bus, plugin, name, plugin);
      for (const Node* field : fields->items) read_field(*field, {list.area, {}, {}, true}, device);
    }
    for (const std::string_view style : {"request", "metric"}) {
      const Node* blocks = child(plugin, style);
      if (!is_list(blocks)) continue;
      for (const Node* block : blocks->items) read_block(*block, plugin, name, bus);
    }
    found_.buses.push_back(std::move(bus));
  }

  void read_block(const Node& block, const Node& plugin, std::string_view name, Bus& bus) {
    other_keys_.look(block, "a request or metric",
                     {"slave_id", "byte_order", "register", "measurement", "fields"});
    const Node* fields = child(block, "fields");
    if (!is_list(fields)) return;
    Device& device = device_of(bus, plugin, name, block);
    for (const Node* field : fields->items) {
      FieldPlace place;
      place.byte_order = text_at(block, "byte_order");
      place.measurement = text_at(block, "measurement");
      std::string_view word = text_at(*field, "register");
      if (word.empty()) word = text_at(block, "register");
      if (word.empty()) word = "holding";
      const auto area = std::ranges::find(kRegisterWords, word, &RegisterWord::word);
      if (area == std::end(kRegisterWords)) {
        refuse(*field, fmt::format("register '{}' is unknown", word));
        continue;
      }
      place.area = area->area;
      read_field(*field, place, device);
    }
  }

  Device& device_of(Bus& bus, const Node& plugin, std::string_view name,
                    const Node& says_slave) const {
    const Slave slave = slave_from(text_at(says_slave, "slave_id"));
    // A request without a slave_id uses 0, as in Telegraf.
    std::optional<std::uint16_t> address;
    if (slave) address = *slave;
    if (slave && !address && &says_slave != &plugin) address = 0;
    for (Device& device : bus.devices) {
      if (device.address == address && slave && device.fault.empty()) return device;
    }
    Device& device = bus.devices.emplace_back();
    device.origin = {source_.file, line_of(says_slave)};
    if (!slave) device.fault = slave.error();
    device.name = bus.devices.size() == 1 || !address ? std::string(name)
                                                      : fmt::format("{}-{}", name, *address);
    device.address = address;
    device.timeout = go_duration(text_at(plugin, "timeout"));
    if (const Node* workarounds = child(plugin, "workarounds")) {
      device.pause = go_duration(text_at(*workarounds, "pause_between_requests"));
      if (device.pause == Duration{}) device.pause.reset();
      if (const auto block = whole_at(*workarounds, "max_word_registers_per_request");
          block && *block >= 1 && *block < 125)
        device.max_block = static_cast<unsigned>(*block);
      if (bool_at(*workarounds, "one_request_per_field") == true) device.max_gap = 0;
    }
    return device;
  }

  void refuse(const Node& field, std::string reason) {
    found_.refusals.push_back(
        {std::string(text_at(field, "name")), {source_.file, line_of(field)}, std::move(reason)});
  }

  void read_field(const Node& field, const FieldPlace& place, Device& device) {
    if (bool_at(field, "omit") == true) return;  // a filler between two fields
    other_keys_.look(field, "a field",
                     {"name", "address", "type", "data_type", "byte_order", "scale", "register",
                      "measurement", "omit", "bit", "length", "output"});
    Point point;
    point.name = text_at(field, "name");
    point.origin = {source_.file, line_of(field)};
    point.refresh = refresh_;
    std::string_view measurement = text_at(field, "measurement");
    if (measurement.empty()) measurement = place.measurement;
    if (!measurement.empty() && measurement != "modbus")
      point.name = fmt::format("{}.{}", measurement, point.name);
    const MayFail fault =
        holds_bits(place.area) ? read_bit(field, place, point) : read_register(field, place, point);
    if (fault) return refuse(field, *fault);
    device.points.push_back(std::move(point));
  }

  // One number; in the style "register" a list of consecutive numbers.
  static tl::expected<std::pair<std::uint64_t, std::size_t>, std::string> address_of(
      const Node& field) {
    const Node* address = child(field, "address");
    if (is_list(address)) {
      std::optional<std::uint64_t> before, first;
      for (const Node* item : address->items) {
        const auto number = whole_from(text_of(item));
        if (!number) return tl::unexpected(fmt::format("'{}' is no address", text_of(item)));
        if (before && *number != *before + 1)
          return tl::unexpected(std::string("its addresses do not follow each other"));
        before = number;
        if (!first) first = number;
      }
      if (!first) return tl::unexpected(std::string("no address"));
      return std::pair(*first, address->items.size());
    }
    const auto number = whole_from(text_of(address));
    if (!number) return tl::unexpected(std::string("no address"));
    return std::pair(*number, std::size_t{0});
  }

  static MayFail read_factor(const Node& field, Point& point) {
    if (const auto fault = fault_of_number(field, "scale")) return fault;
    if (const auto scale = number_at(field, "scale"); scale && *scale != 0) point.scale = *scale;
    return std::nullopt;
  }

  static MayFail read_bit(const Node& field, const FieldPlace& place, Point& point) {
    const auto address = address_of(field);
    if (!address) return address.error();
    const std::string type = lower(text_at(field, "data_type")) + lower(text_at(field, "output"));
    if (const auto fault = read_factor(field, point)) return fault;
    point.type = ValueType::kBool;
    point.at = address_text(place.area, address->first);
    if (type.find("bool") == std::string::npos)
      point.changes.emplace_back("true and false instead of 1 and 0");
    return std::nullopt;
  }

  MayFail read_register(const Node& field, const FieldPlace& place, Point& point) const {
    const auto address = address_of(field);
    if (!address) return address.error();
    std::string_view name = text_at(field, "data_type");
    if (name.empty()) name = text_at(field, "type");
    std::string_view letters = text_at(field, "byte_order");
    if (letters.empty()) letters = place.byte_order;
    const auto orders = letters.empty() ? Orders{} : orders_by_letters(letters);
    if (!orders) return fmt::format("byte order '{}' is unknown", letters);
    point.word_order = orders->words;
    point.byte_order = orders->bytes;
    if (const auto fault = read_factor(field, point)) return fault;
    return read_type(field, lower(name), *address, place, point);
  }

  MayFail read_type(const Node& field, const std::string& name,
                    std::pair<std::uint64_t, std::size_t> address, const FieldPlace& place,
                    Point& point) const {
    const auto [first, count] = address;
    std::optional<std::uint8_t> bit;
    if (name == "bit") {
      const std::uint64_t number = whole_at(field, "bit").value_or(0);
      if (number > 15) return fmt::format("bit {} is not 0 to 15", number);
      // With swapped bytes the bit is in the other byte.
      const bool swapped = point.byte_order == ByteOrder::kLittleEndian;
      bit = static_cast<std::uint8_t>(swapped ? (number + 8) % 16 : number);
      point.type = ValueType::kBool;
    } else if (name == "string") {
      const std::uint64_t registers = whole_at(field, "length").value_or(count);
      if (registers == 0 || registers > kMaxStringBytes / 2)
        return "a text without a length of 1 to 125 registers";
      if (!strings_.empty() && strings_ != "both")
        return "a text with one character in each register";
      point.type = ValueType::kString;
      point.string_bytes = static_cast<std::uint16_t>(2 * registers);
    } else if (name.starts_with("float16")) {
      return "half-precision floats are no type of a channel";
    } else if (name == "fixed" || name == "ufixed" || is_fixed_point(name, place)) {
      const auto type = integer_of(static_cast<unsigned>(16 * count), name == "fixed");
      if (!type || count == 0) return fmt::format("{} of {} registers", name, count);
      point.type = *type;
      if (name == "float32" && count == 2)
        point.changes.emplace_back(
            "FLOAT32 is an unsigned number, as up to Telegraf 1.36; from 1.37 on it is one of "
            "IEEE: FLOAT32-IEEE says that in each of them");
    } else {
      const auto type = type_by_name(name.empty() ? "uint16" : name);
      if (!type) return fmt::format("data type '{}' is unknown", name);
      point.type = type->type;
      point.byte = type->byte;
      if (point.byte && point.byte_order == ByteOrder::kLittleEndian)
        point.byte = static_cast<std::uint8_t>(1 - *point.byte);
    }
    point.at = address_text(place.area, first, bit);
    return std::nullopt;
  }

  // In the style "register", FLOAT32 is an unsigned fixed-point number; FLOAT32-IEEE is a float.
  static bool is_fixed_point(std::string_view name, const FieldPlace& place) {
    return place.in_register_style && name == "float32";
  }

  const SourceText& source_;
  Found& found_;
  OtherKeys other_keys_;
  std::optional<Duration> interval_, refresh_;
  std::string_view strings_;
};

}  // namespace

Confidence recognise_telegraf(const SourceText& source) {
  return source.text.find("[[inputs.modbus]]") != std::string::npos ? kCertain : 0;
}

Read read_telegraf(std::span<const SourceText> sources, const ReadOptions&) {
  Found found;
  for (const SourceText& source : sources) {
    const auto tree = read_toml(source.text);
    if (!tree) return tl::unexpected(fmt::format("{}: {}", source.file, tree.error()));
    TelegrafReader(source, found).read(*(*tree)->root);
  }
  return found;
}

}  // namespace fieldcast::importing
