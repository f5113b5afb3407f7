// mqmgateway (modmqttd): networks become buses, slaves become devices, and values of topics become
// channels. Decimal registers count from 1, hexadecimal ones from 0.
//
// Source: BlackZork/mqmgateway README.md, Configuration.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/base/duration_text.hpp"
#include "tools/import/formats/format.hpp"
#include "tools/import/formats/mqm_converter.hpp"
#include "tools/import/points/address.hpp"
#include "tools/import/points/names.hpp"
#include "tools/import/text/text.hpp"
#include "tools/import/text/tree.hpp"

namespace fieldcast::importing {
namespace {

constexpr unsigned kMaxCount = 125;
constexpr unsigned kMaxNested = 8;

// "1,2,3-10": the slaves of an entry.
std::vector<std::uint16_t> slaves_from(std::string_view text) {
  std::vector<std::uint16_t> slaves;
  for (const std::string_view part : split(text, ',')) {
    const std::size_t dash = part.find('-');
    const auto first = whole_from(part.substr(0, dash));
    const auto last = dash == std::string_view::npos ? first : whole_from(part.substr(dash + 1));
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

// Registers of one value; 0: invalid.
std::uint64_t count_at(const Node& node) {
  return child(node, "count") == nullptr ? 1 : whole_at(node, "count").value_or(0);
}

class MqmReader {
 public:
  MqmReader(const SourceText& source, Found& found) : source_(source), found_(found) {}

  std::optional<std::string> read(const Node& root);

 private:
  using MayFail = std::optional<std::string>;

  void read_network(const Node& network) {
    other_keys_.look(network, "a network",
                     {"name", "device", "baud", "parity", "data_bit", "stop_bit", "address", "port",
                      "slaves", "response_timeout", "delay_before_command", "read_retries"});
    if (const Node* slaves = child(network, "slaves"); is_list(slaves)) {
      for (const Node* slave : slaves->items)
        other_keys_.look(*slave, "a slave",
                         {"name", "address", "write_mode", "response_timeout",
                          "delay_before_command", "read_retries"});
    }
    Bus& bus = found_.buses.emplace_back();
    bus.name = text_at(network, "name");
    bus.origin = {source_.file, line_of(network)};
    if (const auto device = text_at(network, "device"); !device.empty()) {
      bus.port.serial = device;
      if (const auto baud = whole_at(network, "baud"); baud && *baud < 10'000'000)
        bus.port.line.baud = static_cast<std::uint32_t>(*baud);
      const std::string_view parity = text_at(network, "parity");
      bus.port.line.format =
          fmt::format("{}{}{}", whole_at(network, "data_bit").value_or(8),
                      parity.empty() ? 'N' : parity[0], whole_at(network, "stop_bit").value_or(1));
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
    for (Device& device : bus.devices) {
      if (device.address == slave) return device;
    }
    Device& device = bus.devices.emplace_back();
    device.address = slave;
    device.name = fmt::format("slave-{}", slave);
    const Node& network = *networks_.at(bus.name);
    read_times(network, device);
    const Node* slaves = child(network, "slaves");
    if (!is_list(slaves)) return device;
    for (const Node* entry : slaves->items) {
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
    if (const auto retries = whole_at(from, "read_retries"); retries && *retries <= 10)
      device.retries = static_cast<unsigned>(*retries);
  }

  struct Place {
    std::string_view network;
    std::vector<std::uint16_t> slaves;
    std::uint32_t first = 0;
  };

  // "network.slave.register", "slave.register" or "register".
  static tl::expected<Place, std::string> place_of(std::string_view text,
                                                   const Defaults& defaults) {
    Place place{defaults.network, {}, 0};
    std::string_view slave = defaults.slave;
    const auto parts = split(text, '.');
    if (parts.size() > 3) return tl::unexpected(fmt::format("'{}' is no register", text));
    if (parts.size() == 3) place.network = parts[0];
    if (parts.size() >= 2) slave = parts[parts.size() - 2];
    place.slaves = slaves_from(slave);
    const auto number = whole_from(parts.back());
    const bool hex = parts.back().starts_with("0x") || parts.back().starts_with("0X");
    if (!number || (!hex && *number == 0) || *number > 65536)
      return tl::unexpected(
          fmt::format("'{}' is no register (decimal ones count from 1)", parts.back()));
    place.first = static_cast<std::uint32_t>(hex ? *number : *number - 1);
    if (place.slaves.empty()) return tl::unexpected(fmt::format("'{}' names no slave", text));
    return place;
  }

  static std::optional<ModbusArea> area_at(const Node& node) {
    const std::string_view type = text_at(node, "register_type");
    if (type == "coil") return ModbusArea::kCoil;
    if (type == "bit") return ModbusArea::kInput;
    if (type == "input") return ModbusArea::kInputRegister;
    if (type == "holding" || type.empty()) return ModbusArea::kHolding;
    return std::nullopt;
  }

  void refuse(const Node& node, const std::string& name, std::string reason) {
    found_.refusals.push_back({name, {source_.file, line_of(node)}, std::move(reason)});
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
                     {"topic", "network", "slave", "refresh", "state", "availability", "commands"});
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
    if (is_map(commands)) return read_command(*commands, defaults);
    if (!is_list(commands)) return;
    for (const Node* command : commands->items) read_command(*command, defaults);
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
                     {"name", "register", "register_type", "count", "converter", "refresh"});
    const std::string name = name_below(defaults, below);
    const auto place = place_of(text_at(node, "register"), defaults);
    if (!place) return refuse(node, name, place.error());
    const auto area = area_at(node);
    if (!area)
      return refuse(node, name,
                    fmt::format("register type '{}' is unknown", text_at(node, "register_type")));
    const std::uint64_t count = count_at(node);
    if (count < 1 || count > kMaxCount)
      return refuse(node, name, fmt::format("{} registers in one value", text_at(node, "count")));
    Point point;
    point.name = name;
    point.origin = {source_.file, line_of(node)};
    point.refresh = span_at(node, "refresh");
    if (!point.refresh) point.refresh = defaults.refresh;
    if (!change.empty()) point.changes.push_back(change);
    bool array = false;
    if (const auto fault = shape(node, *area, static_cast<unsigned>(count), *place, point, array))
      return refuse(node, name, *fault);
    add_everywhere(node, *place, *area, point, array ? static_cast<unsigned>(count) : 0);
  }

  static MayFail shape(const Node& node, ModbusArea area, unsigned count, const Place& place,
                       Point& point, bool& array) {
    const std::string_view converter = text_at(node, "converter");
    std::optional<std::uint8_t> bit;
    if (holds_bits(area)) {
      if (!converter.empty()) return fmt::format("the converter {} of bits", converter);
      point.type = ValueType::kBool;
      point.changes.emplace_back("true and false instead of 1 and 0");
      array = count > 1;
    } else if (converter.empty()) {
      array = count > 1;
    } else {
      auto converted = convert_mqm(converter, count);
      if (!converted) return converted.error();
      point.type = converted->type;
      point.string_bytes = converted->string_bytes;
      point.byte = converted->byte;
      point.word_order = converted->word_order;
      point.byte_order = converted->byte_order;
      point.scale = converted->scale;
      point.offset = converted->offset;
      bit = converted->bit;
      if (!converted->change.empty()) point.changes.push_back(std::move(converted->change));
    }
    point.at = address_text(area, place.first, bit);
    return std::nullopt;
  }

  void add_everywhere(const Node& node, const Place& place, ModbusArea area, const Point& point,
                      unsigned elements) {
    for (const std::string_view network : split(place.network, ',')) {
      const auto bus = std::ranges::find(found_.buses, network, &Bus::name);
      if (bus == found_.buses.end()) {
        refuse(node, point.name, fmt::format("there is no network '{}'", network));
        continue;
      }
      for (const std::uint16_t slave : place.slaves) {
        if (made_ >= kMaxPoints) return refuse(node, point.name, "too many channels");
        made_ += std::max(elements, 1u);
        std::vector<Point>& points = device_of(*bus, slave).points;
        if (elements > 1) {
          append_array(points, point, area, place.first, elements);
        } else {
          points.push_back(point);
        }
      }
    }
  }

  // A command for an existing read channel makes it writable.
  void read_command(const Node& command, const Defaults& defaults) {
    other_keys_.look(command, "a command",
                     {"name", "register", "register_type", "count", "converter"});
    const std::string name = name_below(defaults, text_at(command, "name"));
    const auto place = place_of(text_at(command, "register"), defaults);
    if (!place) return refuse(command, name, place.error());
    const auto area = area_at(command);
    if (!area || !can_be_written(*area))
      return refuse(command, name, "a command to a register that cannot be written");
    const std::uint64_t count = count_at(command);
    Point point;
    point.name = name;
    point.origin = {source_.file, line_of(command)};
    point.access = Access::kWriteOnly;
    bool array = false;
    if (count < 1 || count > kMaxCount)
      return refuse(command, name,
                    fmt::format("{} registers in one value", text_at(command, "count")));
    if (const auto fault =
            shape(command, *area, static_cast<unsigned>(count), *place, point, array))
      return refuse(command, name, *fault);
    if (array)
      return refuse(command, name, "a list of registers in one command; each channel has its own");
    // divide of a command divides the written value; the channel's scale is the inverse.
    if (point.scale != 1) point.scale = 1 / point.scale;
    for (const std::string_view network : split(place->network, ',')) {
      const auto bus = std::ranges::find(found_.buses, network, &Bus::name);
      if (bus == found_.buses.end()) {
        refuse(command, name, fmt::format("there is no network '{}'", network));
        continue;
      }
      for (const std::uint16_t slave : place->slaves) add_command(device_of(*bus, slave), point);
    }
  }

  static void add_command(Device& device, const Point& point) {
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
  }

  const SourceText& source_;
  Found& found_;
  OtherKeys other_keys_;
  std::map<std::string, const Node*, std::less<>> networks_;
  std::size_t made_ = 0;  // points
};

std::optional<std::string> MqmReader::read(const Node& root) {
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
  other_keys_.tell(source_.file, found_);
  return std::nullopt;
}

}  // namespace

Confidence recognise_mqmgateway(const SourceText& source) {
  const std::string_view text = source.text;
  const auto has = [&](std::string_view word) { return text.find(word) != std::string_view::npos; };
  if (has("modbus:") && has("networks:") && has("mqtt:") && has("objects:")) return kCertain;
  return has("modmqttd:") ? kLikely : 0;
}

Read read_mqmgateway(std::span<const SourceText> sources, const ReadOptions&) {
  Found found;
  for (const SourceText& source : sources) {
    const auto tree = read_yaml_tree(source.text);
    if (!tree) return tl::unexpected(fmt::format("{}: {}", source.file, tree.error()));
    if (const auto fault = MqmReader(source, found).read(*(*tree)->root))
      return tl::unexpected(fmt::format("{}: {}", source.file, *fault));
  }
  return found;
}

}  // namespace fieldcast::importing
