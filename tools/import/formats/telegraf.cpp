// Telegraf configuration: every [[inputs.modbus]] in its three styles. Addresses count from 0.
//
// Source: influxdata/telegraf plugins/inputs/modbus README.md and configuration_*.go (keys, data
// types, byte orders), up to 1.36 and from 1.37 on; grid-x/serial serial.go (baud, parity).
#include "core/base/duration_text.hpp"
#include "tools/import/formats/format.hpp"
#include "tools/import/points/address.hpp"
#include "tools/import/points/types.hpp"

namespace fieldcast::importing {
namespace {

// A list of the style "register", and the value of `register` in the other styles.
struct TelegrafArea {
  std::string_view list, word;
  ModbusArea area;
};
constexpr TelegrafArea kTelegrafAreas[] = {{"coils", "coil", ModbusArea::kCoil},
                                           {"discrete_inputs", "discrete", ModbusArea::kInput},
                                           {"input_registers", "input", ModbusArea::kInputRegister},
                                           {"holding_registers", "holding", ModbusArea::kHolding}};

// Parses "1s", "500ms"; does not support "1m30s".
std::optional<Duration> go_duration(std::string_view text) {
  if (const auto plain = duration_from(text)) return plain;
  if (const auto seconds = number_from(text); seconds && *seconds >= 0 && *seconds < 1e6)
    return std::chrono::milliseconds{static_cast<std::int64_t>(*seconds * 1000)};
  return std::nullopt;
}

Port port_of_controller(const Node& plugin) {
  Port port;
  std::string_view controller = text_at(plugin, "controller");
  const bool file = controller.starts_with("file");
  if (const std::size_t scheme = controller.find("://"); !file && scheme < controller.size()) {
    port.tcp = controller.substr(scheme + 3);
    return port;
  }
  if (controller.starts_with("file://")) controller.remove_prefix(7);
  port.serial = controller;
  // The default of Telegraf's serial library is 19200 8E1.
  port.line = line_at(plugin, {"baud_rate", "data_bits", "parity", "stop_bits", 'E'});
  port.usual = {19200, "Telegraf"};
  return port;
}

std::string protocol_of(const Node& plugin, const Port& port) {
  const std::string mode = lower(text_at(plugin, "transmission_mode"));
  if (mode.starts_with("ascii")) return "modbus-ascii";
  return mode.starts_with("rtu") || port.tcp.empty() ? "modbus-rtu" : "modbus-tcp";
}

struct FieldPlace {
  ModbusArea area = ModbusArea::kHolding;
  std::string_view byte_order, measurement;
  bool in_register_style = false;
};

struct FieldRegisters {
  std::uint64_t first = 0, count = 0;  // count 0: the type determines it
};

// One number; in the style "register" a list of consecutive numbers.
Result<FieldRegisters> registers_at(const Node& field) {
  const Node* address = child(field, "address");
  FieldRegisters found;
  if (!is_list(address)) {
    const auto number = whole_from(text_of(address));
    if (!number) return refused("no address");
    found.first = *number;
    return found;
  }
  for (const Node* item : address->items) {
    const auto number = whole_from(text_of(item));
    if (!number) return refused("'{}' is no address", text_of(item));
    if (found.count == 0) found.first = *number;
    if (*number != found.first + found.count++)
      return refused("its addresses do not follow each other");
  }
  if (found.count == 0) return refused("no address");
  return found;
}

class TelegrafReader : TreeReader {
 public:
  using TreeReader::TreeReader;

  void read(const Node& root) {
    if (const Node* agent = child(root, "agent"))
      interval_ = go_duration(text_at(*agent, "interval"));
    const Node* inputs = child(root, "inputs");
    const Node* plugins = inputs == nullptr ? nullptr : child(*inputs, "modbus");
    if (is_map(plugins)) read_plugin(*plugins);
    for (const Node* plugin : items_of(plugins)) read_plugin(*plugin);
    tell_others();
  }

 private:
  void read_plugin(const Node& plugin) {
    other_keys_.look(plugin, "inputs.modbus",
                     "name controller baud_rate data_bits stop_bits parity transmission_mode "
                     "interval timeout slave_id workarounds configuration_type coils "
                     "discrete_inputs input_registers holding_registers request metric");
    Bus bus;
    bus.origin = origin_of(plugin);
    if (const auto controller = text_at(plugin, "controller"); controller.starts_with("udp:"))
      bus.fault = fmt::format("its controller {}: a bus has no port of UDP", controller);
    bus.port = port_of_controller(plugin);
    bus.protocol = protocol_of(plugin, bus.port);
    strings_ = {};
    if (const Node* workarounds = child(plugin, "workarounds")) {
      other_keys_.look(*workarounds, "workarounds",
                       "string_register_location pause_between_requests "
                       "max_word_registers_per_request one_request_per_field");
      strings_ = text_at(*workarounds, "string_register_location");
    }
    refresh_ = go_duration(text_at(plugin, "interval"));
    if (!refresh_) refresh_ = interval_;
    for (const TelegrafArea& row : kTelegrafAreas) {
      const Node* fields = child(plugin, row.list);
      if (!is_list(fields)) continue;
      Device& device = device_of(bus, plugin, plugin);
      for (const Node* field : fields->items) read_field(*field, {row.area, {}, {}, true}, device);
    }
    for (const std::string_view style : {"request", "metric"}) {
      for (const Node* block : items_of(child(plugin, style))) read_block(*block, plugin, bus);
    }
    found_.buses.push_back(std::move(bus));
  }

  void read_block(const Node& block, const Node& plugin, Bus& bus) {
    other_keys_.look(block, "a request or metric",
                     "slave_id byte_order register measurement fields");
    const Node* fields = child(block, "fields");
    if (!is_list(fields)) return;
    Device& device = device_of(bus, plugin, block);
    for (const Node* field : fields->items) {
      std::string_view word = text_at(*field, "register");
      if (word.empty()) word = text_at(block, "register");
      if (word.empty()) word = "holding";
      const auto* row = std::ranges::find(kTelegrafAreas, word, &TelegrafArea::word);
      if (row == std::end(kTelegrafAreas)) {
        refuse(*field, text_at(*field, "name"), fmt::format("register '{}' is unknown", word));
        continue;
      }
      read_field(*field, {row->area, text_at(block, "byte_order"), text_at(block, "measurement")},
                 device);
    }
  }

  Device& device_of(Bus& bus, const Node& plugin, const Node& says_slave) const {
    const Slave slave = slave_from(text_at(says_slave, "slave_id"));
    // A request without a slave_id uses 0, as in Telegraf.
    std::optional<std::uint16_t> address;
    if (slave) address = *slave;
    if (slave && !address && &says_slave != &plugin) address = 0;
    for (Device& device : bus.devices) {
      if (device.address == address && slave && device.fault.empty()) return device;
    }
    Device& device = bus.devices.emplace_back();
    device.origin = origin_of(says_slave);
    if (!slave) device.fault = slave.error();
    device.name = text_at(plugin, "name");
    if (bus.devices.size() > 1 && address) device.name += fmt::format("-{}", *address);
    device.address = address;
    device.timeout = go_duration(text_at(plugin, "timeout"));
    if (const Node* workarounds = child(plugin, "workarounds")) {
      device.pause = go_duration(text_at(*workarounds, "pause_between_requests"));
      if (device.pause == Duration{}) device.pause.reset();
      device.max_block = small_at(*workarounds, "max_word_registers_per_request", 1, 124);
      if (bool_at(*workarounds, "one_request_per_field") == true) device.max_gap = 0;
    }
    return device;
  }

  void read_field(const Node& field, const FieldPlace& place, Device& device) {
    if (bool_at(field, "omit") == true) return;  // a filler between two fields
    other_keys_.look(field, "a field",
                     "name address type data_type byte_order scale register measurement omit bit "
                     "length output");
    Point point;
    point.name = text_at(field, "name");
    point.origin = origin_of(field);
    point.refresh = refresh_;
    if (MayFail fault = read_point(field, place, point))
      return refuse(field, point.name, std::move(*fault));
    std::string_view measurement = text_at(field, "measurement");
    if (measurement.empty()) measurement = place.measurement;
    if (!measurement.empty() && measurement != "modbus")
      point.name = fmt::format("{}.{}", measurement, point.name);
    device.points.push_back(std::move(point));
  }

  MayFail read_point(const Node& field, const FieldPlace& place, Point& point) const {
    const auto registers = registers_at(field);
    if (!registers) return registers.error();
    if (holds_bits(place.area)) {
      const std::string type = lower(text_at(field, "data_type")) + lower(text_at(field, "output"));
      if (!contains(type, "bool")) point.changes.emplace_back(kTruthNotNumber);
      point.type = ValueType::kBool;
    } else {
      std::string_view letters = text_at(field, "byte_order");
      if (letters.empty()) letters = place.byte_order;
      const auto orders = letters.empty() ? Orders{} : orders_by_letters(letters);
      if (!orders) return fmt::format("byte order '{}' is unknown", letters);
      point.word_order = orders->words;
      point.byte_order = orders->bytes;
    }
    if (auto fault = read_scale_at(field, "scale", point.scale)) return fault;
    if (!holds_bits(place.area)) {
      if (auto fault = read_type(field, place, registers->count, point)) return fault;
    }
    point.at = address_text(place.area, registers->first, point.bit);
    return std::nullopt;
  }

  MayFail read_type(const Node& field, const FieldPlace& place, std::uint64_t count,
                    Point& point) const {
    const std::string name = lower(first_text(field, {"data_type", "type"}));
    const bool swapped = point.byte_order == ByteOrder::kLittleEndian;
    // In the style "register", FLOAT32 is an unsigned number; FLOAT32-IEEE is a float.
    const bool old_float = place.in_register_style && name == "float32";
    if (name == "bit") {
      const std::uint64_t number = whole_at(field, "bit").value_or(0);
      if (number > 15) return fmt::format("bit {} is not 0 to 15", number);
      // With swapped bytes the bit is in the other byte.
      point.bit = static_cast<std::uint8_t>(swapped ? (number + 8) % 16 : number);
      point.type = ValueType::kBool;
    } else if (name == "string") {
      const std::uint64_t length = whole_at(field, "length").value_or(count);
      if (length == 0 || length > kMaxStringBytes / 2) return kTextLength;
      if (!strings_.empty() && strings_ != "both") return kSparseText;
      point.type = ValueType::kString;
      point.string_bytes = static_cast<std::uint16_t>(2 * length);
    } else if (name.starts_with("float16")) {
      return "half-precision floats are no type of a channel";
    } else if (name == "fixed" || name == "ufixed" || old_float) {
      const auto type = integer_of(static_cast<unsigned>(16 * count), name == "fixed");
      if (!type) return fmt::format("{} of {} registers", name, count);
      point.type = *type;
      if (old_float && count == 2)
        point.change(
            "FLOAT32 is an unsigned number, as up to Telegraf 1.36; from 1.37 on it is one of "
            "IEEE: FLOAT32-IEEE says that in each of them");
    } else {
      const auto type = type_by_name(name.empty() ? "uint16" : name);
      if (!type) return fmt::format("data type '{}' is unknown", name);
      point.type = type->type;
      point.byte = type->byte;
      if (point.byte && swapped) point.byte = static_cast<std::uint8_t>(1 - *point.byte);
    }
    return std::nullopt;
  }

  std::optional<Duration> interval_, refresh_;
  std::string_view strings_;
};

Confidence recognise_telegraf(const SourceText& source) {
  return confidence_by(source.text, {{"[[inputs.modbus]]", kCertain}});
}

Read read_telegraf(Sources sources, const ReadOptions&) {
  return read_each_tree(sources, read_toml,
                        [](const SourceText& source, const Node& root, Found& found) {
                          TelegrafReader(source, found).read(root);
                          return MayFail();
                        });
}

}  // namespace

constinit const Format kTelegrafFormat{"telegraf", "Telegraf inputs.modbus (TOML)",
                                       recognise_telegraf, read_telegraf, "0"};

}  // namespace fieldcast::importing
