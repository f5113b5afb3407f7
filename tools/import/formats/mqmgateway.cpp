// mqmgateway (modmqttd): networks become buses, slaves become devices, and values of topics become
// channels. Decimal registers count from 1, hexadecimal ones from 0.
//
// Source: BlackZork/mqmgateway README.md (Configuration, Data conversion), and stdconv/*.hpp:
// divide and multiply treat two registers as signed, and bits count from 1.
#include <algorithm>
#include <map>

#include "core/base/duration_text.hpp"
#include "tools/import/formats/expression.hpp"
#include "tools/import/formats/format.hpp"
#include "tools/import/points/address.hpp"

namespace fieldcast::importing {
namespace {

struct Arguments {
  std::vector<std::string> positional;
  std::map<std::string, std::string, std::less<>> named;

  [[nodiscard]] std::string get(std::string_view name, std::size_t index) const {
    if (const auto found = named.find(name); found != named.end()) return found->second;
    return index < positional.size() ? positional[index] : std::string();
  }
  [[nodiscard]] bool flag(std::string_view name, std::size_t index) const {
    const std::string word = lower(get(name, index));
    return word == name || is_one_of(word, "true 1");
  }
};

std::string without_quotes(std::string_view text) {
  text = trimmed(text);
  const bool quoted =
      text.size() > 1 && (text[0] == '"' || text[0] == '\'') && text.back() == text[0];
  return std::string(quoted ? text.substr(1, text.size() - 2) : text);
}

void add_argument(std::string_view text, Arguments& arguments) {
  const auto [name, value] = halves(text, '=');
  const std::string_view key = trimmed(name);
  const bool named = name.size() < text.size() && !key.empty() &&
                     key.find_first_not_of("abcdefghijklmnopqrstuvwxyz_") == std::string::npos;
  if (named) {
    arguments.named.try_emplace(std::string(key), without_quotes(value));
  } else if (!trimmed(text).empty()) {
    arguments.positional.push_back(without_quotes(text));
  }
}

// Commas inside quotes and brackets do not separate arguments.
Arguments arguments_of(std::string_view text) {
  Arguments arguments;
  char quote = '\0';
  int depth = 0;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quote != '\0') {
      if (c == quote) quote = '\0';
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '(' || c == '{') {
      ++depth;
    } else if (c == ')' || c == '}') {
      --depth;
    } else if (c == ',' && depth == 0) {
      add_argument(text.substr(begin, i - begin), arguments);
      begin = i + 1;
    }
  }
  add_argument(text.substr(begin), arguments);
  return arguments;
}

MayFail scaled(const Arguments& arguments, unsigned count, bool divide, Point& point) {
  const auto number = number_from(arguments.get(divide ? "divisor" : "multipler", 0));
  if (!number || *number == 0) return "a scale that is no number";
  if (count > 2) return fmt::format("a scale of {} registers", count);
  point.type = count == 2 ? ValueType::kInt32 : ValueType::kUint16;
  point.scale = divide ? 1 / *number : *number;
  point.set_orders(arguments.flag("low_first", 2), arguments.flag("swap_bytes", 3));
  return std::nullopt;
}

MayFail expression(const Arguments& arguments, unsigned count, Point& point) {
  const std::string text = arguments.get("expression", 0);
  const auto form = linear_form(text);
  if (!form) return fmt::format("the expression {} is not linear in one value", text);
  std::string_view function = form->function;
  const bool swapped = function.ends_with("bs");
  if (swapped) function.remove_suffix(2);
  constexpr Words<ValueType> kTypes[] = {{"int32", ValueType::kInt32},
                                         {"uint32", ValueType::kUint32},
                                         {"flt32", ValueType::kFloat32},
                                         {"int16", ValueType::kInt16}};
  point.type = value_of(kTypes, function).value_or(ValueType::kUint16);
  if (function.ends_with("32") && count < 2) return fmt::format("{} of one register", function);
  point.set_orders(form->low_first, swapped);
  point.scale = form->scale;
  point.offset = form->offset;
  return std::nullopt;
}

// Converters that are a type: the number of their registers, and where their flags are among the
// arguments without a name.
struct TypeConverter {
  std::string_view names;
  ValueType type;
  unsigned registers;
  std::optional<std::size_t> first, low_first, swap_bytes;
};
constexpr TypeConverter kTypeConverters[] = {
    {"int8", ValueType::kInt8, 1, 0, {}, {}},
    {"uint8", ValueType::kUint8, 1, 0, {}, {}},
    {"int16", ValueType::kInt16, 1, {}, {}, 0},
    {"uint16", ValueType::kUint16, 1, {}, {}, 0},
    {"int32", ValueType::kInt32, 2, {}, 0, 1},
    {"uint32", ValueType::kUint32, 2, {}, 0, 1},
    {"float32 float", ValueType::kFloat32, 2, {}, 1, 2}};  // after the precision

MayFail standard(std::string_view name, const Arguments& arguments, unsigned count, Point& point) {
  if (is_one_of(name, "divide multiply")) return scaled(arguments, count, name == "divide", point);
  for (const TypeConverter& converter : kTypeConverters) {
    if (!is_one_of(name, converter.names)) continue;
    if (count != converter.registers)
      return fmt::format("{} of {} registers", to_text(converter.type), count);
    const auto flag = [&](std::string_view flag_name, std::optional<std::size_t> index) {
      return index && arguments.flag(flag_name, *index);
    };
    point.type = converter.type;
    if (converter.first) point.byte = flag("first", converter.first) ? 1 : 0;
    point.set_orders(flag("low_first", converter.low_first),
                     flag("swap_bytes", converter.swap_bytes));
    return std::nullopt;
  }
  if (name == "bit") {
    const auto number = whole_from<std::uint8_t>(arguments.get("bit", 0), 1, 16);
    if (!number) return "a bit that is not 1 to 16";
    point.type = ValueType::kBool;
    point.bit = *number - 1;
    point.changes.emplace_back(kTruthNotNumber);
  } else if (name == "bitmask") {
    const std::string mask = arguments.get("mask", 0);
    if (!mask.empty() && whole_from(mask) != 0xFFFFu)
      return "some bits of a register; a channel has one bit or all";
  } else if (name == "string") {
    if (2 * count > kMaxStringBytes) return fmt::format("a text of {} registers", count);
    point.type = ValueType::kString;
    point.string_bytes = static_cast<std::uint16_t>(2 * count);
  } else if (name == "map") {
    if (count != 1) return "a map of several registers";
    point.change("the number of the register, not the text that it is mapped to");
  } else {
    return fmt::format("the converter std.{} has no counterpart", name);
  }
  return std::nullopt;
}

// `std.divide(10)` or `expr.evaluate("int32(R0, R1) / 100")`: fills type, bit, orders, scale and
// changes of a point of 1 to 125 registers.
MayFail convert(std::string_view converter, unsigned count, Point& point) {
  converter = trimmed(converter);
  const std::size_t open = std::min(converter.find('('), converter.size());
  const std::string_view name = trimmed(converter.substr(0, open));
  std::string_view inside = converter.substr(open);
  if (!inside.empty()) {
    const std::size_t close = inside.rfind(')');
    if (close == std::string_view::npos)
      return fmt::format("the converter '{}' has no ')'", converter);
    inside = inside.substr(1, close - 1);
  }
  const Arguments arguments = arguments_of(inside);
  if (name.starts_with("std.")) return standard(name.substr(4), arguments, count, point);
  if (name == "expr.evaluate") return expression(arguments, count, point);
  return fmt::format("the converter {} has no counterpart", name);
}

constexpr unsigned kMaxCount = 125;
constexpr unsigned kMaxNested = 8;

std::vector<std::uint16_t> slaves_from(std::string_view text) {
  std::vector<std::uint16_t> slaves;
  for (const std::string_view part : split(text, ',')) {
    const auto [begin, end] = halves(part, '-');
    const auto first = whole_from(begin);
    const auto last = begin.size() == part.size() ? first : whole_from(end);
    if (!first || !last || *last > 255) continue;
    for (std::uint64_t slave = *first; slave <= *last; ++slave)
      slaves.push_back(static_cast<std::uint16_t>(slave));
  }
  return slaves;
}

std::optional<Duration> span_at(const Node& map, std::string_view key) {
  const auto span = duration_from(text_at(map, key));
  return span && *span > Duration{} ? span : std::nullopt;
}

// Values inherited from the levels above.
struct Defaults {
  std::string_view network, slave, topic;
  std::optional<Duration> refresh;
};

struct Place {
  std::string_view network;
  std::vector<std::uint16_t> slaves;
  std::uint32_t first = 0;
};

// "network.slave.register", "slave.register" or "register".
Result<Place> place_of(std::string_view text, const Defaults& defaults) {
  Place place{defaults.network, {}, 0};
  std::string_view slave = defaults.slave;
  const auto parts = split(text, '.');
  if (parts.size() > 3) return refused("'{}' is no register", text);
  if (parts.size() == 3) place.network = parts[0];
  if (parts.size() >= 2) slave = parts[parts.size() - 2];
  place.slaves = slaves_from(slave);
  const bool hex = parts.back().starts_with("0x") || parts.back().starts_with("0X");
  const auto number = whole_from(parts.back(), hex ? 0 : 1, 65536);
  if (!number) return refused("'{}' is no register (decimal ones count from 1)", parts.back());
  place.first = static_cast<std::uint32_t>(hex ? *number : *number - 1);
  if (place.slaves.empty()) return refused("'{}' names no slave", text);
  return place;
}

constexpr Words<ModbusArea> kMqmAreas[] = {{"coil", ModbusArea::kCoil},
                                           {"bit", ModbusArea::kInput},
                                           {"input", ModbusArea::kInputRegister},
                                           {"holding", ModbusArea::kHolding}};

struct MqmValue {
  Place place;
  ModbusArea area = ModbusArea::kHolding;
  unsigned elements = 0;  // 0: not an array
  Point point;
};

class MqmReader : TreeReader {
 public:
  MqmReader(const SourceText& source, Found& found)
      : TreeReader(source, found), first_bus_(found.buses.size()) {}

  MayFail read(const Node& root) {
    const Node* modbus = child(root, "modbus");
    const Node* networks = modbus == nullptr ? nullptr : child(*modbus, "networks");
    const Node* mqtt = child(root, "mqtt");
    const Node* objects = mqtt == nullptr ? nullptr : child(*mqtt, "objects");
    if (!is_list(networks)) return "it names no networks (modbus: networks:)";
    if (!is_list(objects)) return "it names no objects (mqtt: objects:)";
    for (const Node* network : networks->items) read_network(*network);
    Defaults defaults;
    defaults.refresh = span_at(*mqtt, "refresh").value_or(std::chrono::seconds{5});
    for (const Node* object : objects->items) read_object(*object, defaults);
    tell_others();
    return std::nullopt;
  }

 private:
  void read_network(const Node& network) {
    other_keys_.look(network, "a network",
                     "name device baud parity data_bit stop_bit address port slaves "
                     "response_timeout delay_before_command read_retries");
    for (const Node* slave : items_of(child(network, "slaves")))
      other_keys_.look(
          *slave, "a slave",
          "name address write_mode response_timeout delay_before_command read_retries");
    Bus& bus = found_.buses.emplace_back();
    bus.name = text_at(network, "name");
    bus.origin = origin_of(network);
    if (const auto device = text_at(network, "device"); !device.empty()) {
      bus.port.serial = device;
      bus.port.line = line_at(network, {"baud", "data_bit", "parity", "stop_bit"});
      bus.protocol = "modbus-rtu";
    } else {
      bus.port.tcp = tcp_at(network, "address", "port");
      bus.protocol = "modbus-tcp";
    }
    networks_[bus.name] = &network;
  }

  Device& device_of(Bus& bus, std::uint16_t slave) {
    Device& device = device_at(bus, slave);
    if (!device.name.empty()) return device;
    device.name = fmt::format("slave-{}", slave);
    const Node& network = *networks_.at(bus.name);
    read_times(network, device);
    for (const Node* entry : items_of(child(network, "slaves"))) {
      const auto addresses = slaves_from(text_at(*entry, "address"));
      if (std::ranges::find(addresses, slave) == addresses.end()) continue;
      read_times(*entry, device);
      if (const auto name = text_at(*entry, "name"); !name.empty()) device.name = name;
      if (text_at(*entry, "write_mode") == "force_multiple_registers") device.write_multiple = true;
    }
    return device;
  }

  static void read_times(const Node& from, Device& device) {
    if (const auto span = span_at(from, "response_timeout")) device.timeout = span;
    if (const auto span = span_at(from, "delay_before_command")) device.pause = span;
    if (const auto retries = small_at(from, "read_retries", 0, 10)) device.retries = retries;
  }

  // Joins the topic without its placeholders, which distinguish devices, and the name.
  static std::string name_below(const Defaults& defaults, std::string_view name) {
    std::string topic;
    for (std::size_t i = 0; i < defaults.topic.size(); ++i) {
      if (defaults.topic.substr(i).starts_with("${")) {
        i = std::min(defaults.topic.find('}', i), defaults.topic.size() - 1);
      } else {
        topic += defaults.topic[i];
      }
    }
    return name.empty() ? topic : fmt::format("{}/{}", topic, name);
  }

  void read_object(const Node& object, const Defaults& above) {
    other_keys_.look(object, "an object",
                     "topic network slave refresh state availability commands");
    Defaults defaults = above;
    defaults.topic = text_at(object, "topic");
    if (const auto text = text_at(object, "network"); !text.empty()) defaults.network = text;
    if (const auto text = text_at(object, "slave"); !text.empty()) defaults.slave = text;
    if (const auto span = span_at(object, "refresh")) defaults.refresh = span;
    if (const Node* state = child(object, "state")) read_state(*state, defaults, {}, 0);
    if (const Node* availability = child(object, "availability")) {
      const std::string_view name = text_at(*availability, "name");
      read_value(*availability, defaults, name.empty() ? "availability" : std::string(name),
                 "the quality of the other channels does not depend on it");
    }
    const Node* commands = child(object, "commands");
    if (is_map(commands)) read_command(*commands, defaults);
    for (const Node* command : items_of(commands)) read_command(*command, defaults);
  }

  void read_state(const Node& state, Defaults defaults, const std::string& below, unsigned depth) {
    if (depth > kMaxNested) return refuse(state, name_below(defaults, below), "nested too deep");
    if (const auto span = span_at(state, "refresh")) defaults.refresh = span;
    const auto name_of = [&](const Node& node, std::size_t index, std::size_t count) {
      std::string name(text_at(node, "name"));
      if (name.empty() && count > 1) name = std::to_string(index);
      return below.empty() ? name : name.empty() ? below : fmt::format("{}/{}", below, name);
    };
    if (is_list(&state)) {
      for (std::size_t i = 0; i < state.items.size(); ++i)
        read_state(*state.items[i], defaults, name_of(*state.items[i], i, state.items.size()),
                   depth + 1);
      return;
    }
    if (const Node* registers = child(state, "registers"); is_list(registers)) {
      const std::string name = depth == 0 ? name_of(state, 0, 1) : below;
      if (!text_at(state, "converter").empty())
        return refuse(state, name_below(defaults, name), "one value of registers that stand apart");
      return read_state(*registers, defaults, name, depth + 1);
    }
    read_value(state, defaults, depth == 0 ? name_of(state, 0, 1) : below, {});
  }

  void read_value(const Node& node, const Defaults& defaults, const std::string& below,
                  const std::string& change) {
    other_keys_.look(node, "a state or availability",
                     "name register register_type count converter refresh");
    const std::string name = name_below(defaults, below);
    auto value = value_at(node, defaults, false);
    if (!value) return refuse(node, name, value.error());
    Point& point = value->point;
    point.name = name;
    point.refresh = span_at(node, "refresh");
    if (!point.refresh) point.refresh = defaults.refresh;
    if (!change.empty()) point.changes.insert(point.changes.begin(), change);
    on_each_device(node, value->place, name, [&](Device& device) {
      const bool full = made_ >= kMaxPoints;
      if (full) {
        refuse(node, name, "too many channels");
      } else {
        made_ += std::max(value->elements, 1u);
        append_points(device.points, point, value->area, value->place.first, value->elements);
      }
      return !full;
    });
  }

  Result<MqmValue> value_at(const Node& node, const Defaults& defaults, bool command) const {
    MqmValue value;
    auto place = place_of(text_at(node, "register"), defaults);
    if (!place) return tl::unexpected(place.error());
    value.place = *std::move(place);
    const std::string_view type = text_at(node, "register_type");
    const auto area = type.empty() ? ModbusArea::kHolding : value_of(kMqmAreas, type);
    if (command && !(area && can_be_written(*area)))
      return refused("a command to a register that cannot be written");
    if (!area) return refused("register type '{}' is unknown", type);
    value.area = *area;
    const bool one = child(node, "count") == nullptr;
    const auto count = one ? 1 : small_at(node, "count", 1, kMaxCount);
    if (!count) return refused("{} registers in one value", text_at(node, "count"));
    value.point.origin = origin_of(node);
    const std::string_view converter = text_at(node, "converter");
    if (*count > 1 && (holds_bits(*area) || converter.empty())) value.elements = *count;
    if (holds_bits(*area)) {
      if (!converter.empty()) return refused("the converter {} of bits", converter);
      value.point.type = ValueType::kBool;
      value.point.changes.emplace_back(kTruthNotNumber);
    } else if (!converter.empty()) {
      if (auto fault = convert(converter, *count, value.point))
        return tl::unexpected(std::move(*fault));
    }
    value.point.at = address_text(*area, value.place.first, value.point.bit);
    return value;
  }

  template <typename Action>
  void on_each_device(const Node& node, const Place& place, const std::string& name,
                      const Action& action) {
    for (const std::string_view network : split(place.network, ',')) {
      const auto own = std::span(found_.buses).subspan(first_bus_);
      const auto bus = std::ranges::find(own, network, &Bus::name);
      if (bus == own.end()) {
        refuse(node, name, fmt::format("there is no network '{}'", network));
        continue;
      }
      for (const std::uint16_t slave : place.slaves) {
        if (!action(device_of(*bus, slave))) return;
      }
    }
  }

  // A command for an existing read channel makes it writable.
  void read_command(const Node& command, const Defaults& defaults) {
    other_keys_.look(command, "a command", "name register register_type count converter");
    const std::string name = name_below(defaults, text_at(command, "name"));
    auto value = value_at(command, defaults, true);
    if (!value) return refuse(command, name, value.error());
    if (value->elements > 0)
      return refuse(command, name, "a list of registers in one command; each channel has its own");
    Point& point = value->point;
    point.name = name;
    point.access = Access::kWriteOnly;
    // divide of a command divides the written value; the channel's scale is the inverse.
    if (point.scale != 1) point.scale = 1 / point.scale;
    on_each_device(command, value->place, name, [&](Device& device) {
      const auto read = std::ranges::find_if(device.points, [&](const Point& other) {
        return other.at == point.at && other.type == point.type && other.scale == point.scale &&
               other.offset == point.offset && other.word_order == point.word_order &&
               other.byte_order == point.byte_order && other.access == Access::kReadOnly;
      });
      if (read == device.points.end()) {
        device.points.push_back(point);
      } else {
        read->access = Access::kReadWrite;
      }
      return true;
    });
  }

  const std::size_t first_bus_;  // of this file; those before are of other files
  std::map<std::string, const Node*, std::less<>> networks_;
  std::size_t made_ = 0;  // points
};

Confidence recognise_mqmgateway(const SourceText& source) {
  return confidence_by(source.text,
                       {{"modbus: networks: mqtt: objects:", kCertain}, {"modmqttd:", kLikely}});
}

Read read_mqmgateway(Sources sources, const ReadOptions&) {
  return read_each_tree(sources, read_yaml_tree,
                        [](const SourceText& source, const Node& root, Found& found) {
                          return MqmReader(source, found).read(root);
                        });
}

}  // namespace

constinit const Format kMqmgatewayFormat{"mqmgateway", "mqmgateway, modmqttd (YAML)",
                                         recognise_mqmgateway, read_mqmgateway,
                                         "1, hexadecimal ones from 0"};

}  // namespace fieldcast::importing
