// mqmgateway (modmqttd): networks become buses, slaves become devices, and values of topics become
// channels. Decimal registers count from 1, hexadecimal ones from 0.
//
// Source: BlackZork/mqmgateway README.md, Configuration.
#include <algorithm>
#include <map>

#include "core/base/duration_text.hpp"
#include "tools/import/formats/format.hpp"
#include "tools/import/formats/mqm_converter.hpp"
#include "tools/import/points/address.hpp"

namespace fieldcast::importing {
namespace {

constexpr unsigned kMaxCount = 125;
constexpr unsigned kMaxNested = 8;

// "1,2,3-10": the slaves of an entry.
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

// Where a value is, on each slave of the list.
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

// One value of a state or a command.
struct MqmValue {
  Place place;
  ModbusArea area = ModbusArea::kHolding;
  unsigned elements = 0;  // 0: not an array
  Point point;
};

class MqmReader : TreeReader {
 public:
  MqmReader(const SourceText& source, Found& found) : TreeReader(source, found) {}

  MayFail read(const Node& root);

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
      bus.port.tcp = fmt::format("{}:{}", text_at(network, "address"),
                                 whole_at(network, "port").value_or(502));
      bus.protocol = "modbus-tcp";
    }
    networks_[bus.name] = &network;
  }

  // With the settings of the network and of `slaves`.
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

  // `command`: the registers must be writable.
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
    std::optional<std::uint8_t> bit;
    if (holds_bits(*area)) {
      if (!converter.empty()) return refused("the converter {} of bits", converter);
      value.point.type = ValueType::kBool;
      value.point.changes.emplace_back(kTruthNotNumber);
    } else if (!converter.empty()) {
      if (auto fault = convert_mqm(converter, *count, value.point, bit))
        return tl::unexpected(std::move(*fault));
    }
    value.point.at = address_text(*area, value.place.first, bit);
    return value;
  }

  // Stops when `action` returns false.
  template <typename Action>
  void on_each_device(const Node& node, const Place& place, const std::string& name,
                      const Action& action) {
    for (const std::string_view network : split(place.network, ',')) {
      const auto bus = std::ranges::find(found_.buses, network, &Bus::name);
      if (bus == found_.buses.end()) {
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

  std::map<std::string, const Node*, std::less<>> networks_;
  std::size_t made_ = 0;  // points
};

MayFail MqmReader::read(const Node& root) {
  const Node* modbus = child(root, "modbus");
  const Node* networks = modbus == nullptr ? nullptr : child(*modbus, "networks");
  const Node* mqtt = child(root, "mqtt");
  const Node* objects = mqtt == nullptr ? nullptr : child(*mqtt, "objects");
  if (!is_list(networks)) return "it names no networks (modbus: networks:)";
  if (!is_list(objects)) return "it names no objects (mqtt: objects:)";
  for (const Node* network : networks->items) read_network(*network);
  Defaults defaults;
  defaults.refresh = span_at(*mqtt, "refresh");
  if (!defaults.refresh) defaults.refresh = std::chrono::seconds{5};
  for (const Node* object : objects->items) read_object(*object, defaults);
  tell_others();
  return std::nullopt;
}

Confidence recognise_mqmgateway(const SourceText& source) {
  const std::string_view text = source.text;
  const auto has = [&](std::string_view word) { return contains(text, word); };
  if (has("modbus:") && has("networks:") && has("mqtt:") && has("objects:")) return kCertain;
  return has("modmqttd:") ? kLikely : 0;
}

Read read_mqmgateway(std::span<const SourceText> sources, const ReadOptions&) {
  Found found;
  for (const SourceText& source : sources) {
    const auto tree = read_yaml_tree(source.text);
    if (!tree) return refused("{}: {}", source.file, tree.error());
    if (const auto fault = MqmReader(source, found).read(*(*tree)->root))
      return refused("{}: {}", source.file, *fault);
  }
  return found;
}

}  // namespace

constinit const Format kMqmgatewayFormat{"mqmgateway", "mqmgateway, modmqttd (YAML)",
                                         recognise_mqmgateway, read_mqmgateway,
                                         "1, hexadecimal ones from 0"};

}  // namespace fieldcast::importing
