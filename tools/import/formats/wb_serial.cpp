// wb-mqtt-serial: device templates, and configurations whose devices use them.
//
// Source: wirenboard/wb-mqtt-serial README.md (keys of a channel), templates/, src/register.cpp
// (addresses of parts), docs of Wiren Board MQTT conventions (units by control type).
#include <algorithm>
#include <map>

#include "tools/import/formats/expression.hpp"
#include "tools/import/formats/format.hpp"
#include "tools/import/points/address.hpp"
#include "tools/import/points/types.hpp"

namespace fieldcast::importing {
namespace {

constexpr unsigned kMaxParts = 8;         // nesting depth of parts
constexpr unsigned kMaxPartsRead = 5000;  // of a device

constexpr Words<ModbusArea> kWbAreas[] = {
    {"coil", ModbusArea::kCoil},
    {"discrete", ModbusArea::kInput},
    {"input press_counter", ModbusArea::kInputRegister},
    {"holding holding_single holding_multi", ModbusArea::kHolding}};
constexpr std::string_view kFormats =
    "u16 s16 u8 s8 u32 s32 u64 s64 float double bcd8 bcd16 bcd32 string8";

struct WbUnit {
  std::string_view word, unit;
};
constexpr WbUnit kUnits[] = {{"deg C", "°C"},   {"%, RH", "% RH"}, {"m^3", "m³"}, {"m^3/h", "m³/h"},
                             {"g/m^3", "g/m³"}, {"Па", "Pa"},      {"deg", "°"}};
constexpr WbUnit kUnitsOfTypes[] = {{"temperature", "°C"},
                                    {"rel_humidity", "% RH"},
                                    {"voltage", "V"},
                                    {"current", "A"},
                                    {"power", "W"},
                                    {"power_consumption", "kWh"},
                                    {"lux", "lx"},
                                    {"sound_level", "dB"},
                                    {"concentration", "ppm"},
                                    {"pressure", "bar"},
                                    {"resistance", "Ω"},
                                    {"atmospheric_pressure", "mbar"},
                                    {"heat_power", "Gcal/h"},
                                    {"heat_energy", "Gcal"},
                                    {"water_flow", "m³/h"},
                                    {"water_consumption", "m³"}};

std::string unit_of(const Node& channel) {
  const std::string_view said = text_at(channel, "units");
  const auto known = std::ranges::find(kUnits, said, &WbUnit::word);
  if (known != std::end(kUnits)) return std::string(known->unit);
  if (!said.empty()) return std::string(said);
  const auto by_type = std::ranges::find(kUnitsOfTypes, text_at(channel, "type"), &WbUnit::word);
  return by_type == std::end(kUnitsOfTypes) ? std::string() : std::string(by_type->unit);
}

// "109", "0x6D", "109:1:2": some bits of a register.
struct WbAddress {
  std::uint32_t first = 0;
  std::optional<std::uint64_t> shift, width;  // of some bits
};

Result<WbAddress> address_of(const Node& channel, Point& point) {
  std::string_view text = text_at(channel, "address");
  const std::string_view other = text_at(channel, "write_address");
  if (text.empty()) {
    if (other.empty()) return refused("no address");
    text = other;
    point.access = Access::kWriteOnly;
  } else if (!other.empty() && whole_from(other) != whole_from(text)) {
    point.access = Access::kReadOnly;
    point.change("read only: it is written at the address {}", other);
  }
  const auto parts = split(text, ':');
  const auto first = whole_from<std::uint32_t>(parts[0], 0, 65535);
  const auto shift = parts.size() > 1 ? whole_from(parts[1], 0, 63) : std::nullopt;
  const auto width = parts.size() > 2 ? whole_from(parts[2], 1, 64) : std::nullopt;
  if (!first || (parts.size() > 1 && (!shift || !width)))
    return refused("'{}' is no address of Modbus", text);
  return WbAddress{*first, shift, width};
}

MayFail read_format(const Node& channel, Point& point) {
  std::string_view format = text_at(channel, "format");
  if (format.empty()) format = "u16";
  if (format == "string") return kSparseText;
  if (!is_one_of(format, kFormats)) return fmt::format("the format {} has no counterpart", format);
  point.type = type_by_name(format)->type;
  if (is_byte(point.type) || point.type == ValueType::kBcd8) point.byte = 0;
  if (point.type == ValueType::kString) {
    const auto registers = small_at(channel, "string_data_size", 1, kMaxStringBytes / 2);
    if (!registers) return kTextLength;
    point.string_bytes = static_cast<std::uint16_t>(2 * *registers);
  }
  const bool low_byte_first = text_at(channel, "byte_order") == "little_endian";
  point.set_orders(text_at(channel, "word_order") == "little_endian", low_byte_first);
  if (point.byte && low_byte_first) point.byte = 1;
  return std::nullopt;
}

MayFail read_register_part(const WbAddress& address, Point& point) {
  if (!address.width) return std::nullopt;
  const bool swapped = point.byte_order == ByteOrder::kLittleEndian;
  const bool one_register = registers_of(point.type, 2) == 1;
  if (*address.width == 16 && *address.shift == 0 && one_register) return std::nullopt;
  if (!one_register || *address.shift > 15) return "bits of a value of several registers";
  if (*address.width == 1) {
    point.type = ValueType::kBool;
    point.bit = static_cast<std::uint8_t>(swapped ? (*address.shift + 8) % 16 : *address.shift);
    point.byte.reset();
    return std::nullopt;
  }
  if (*address.width == 8 && *address.shift % 8 == 0) {
    const bool with_sign = point.type == ValueType::kInt8 || point.type == ValueType::kInt16;
    point.type = with_sign ? ValueType::kInt8 : ValueType::kUint8;
    point.byte = (*address.shift == 8) != swapped ? 1 : 0;
    return std::nullopt;
  }
  return fmt::format("{} bits of a register; a channel has one bit, a byte or all", *address.width);
}

MayFail read_numbers(const Node& channel, Point& point) {
  if (auto fault = read_scale_at(channel, "scale", point.scale)) return fault;
  if (auto fault = fault_of_number(channel, "offset")) return fault;
  point.offset = number_at(channel, "offset").value_or(0);
  if (const std::string_view error = text_at(channel, "error_value"); !error.empty())
    point.change("the raw value {} means an error", error);
  if (point.access == Access::kReadOnly || !is_number(point.type)) return std::nullopt;
  const auto low = number_at(channel, "min"), high = number_at(channel, "max");
  if (low && high && *low <= *high) {
    point.write_min = low;
    point.write_max = high;
  }
  return std::nullopt;
}

// Values for on and off. For a single bit, 1 is always on.
MayFail read_switch(const Node& channel, Point& point) {
  std::string_view on = text_at(channel, "on_value"), off = text_at(channel, "off_value");
  if (on.empty() && off.empty()) return std::nullopt;
  if (on.empty()) on = "1";
  if (off.empty()) off = "0";
  if (point.type != ValueType::kBool) {
    point.change("a number: {} is on, {} is off", on, off);
  } else if (whole_from(on) == 0u || whole_from(off) != 0u) {
    return fmt::format(
        "a bit that means the opposite (on_value {}, off_value {}); a channel's is on at 1", on,
        off);
  }
  return std::nullopt;
}

struct WbBase {
  std::uint32_t shift = 0;   // registers
  std::uint32_t stride = 0;  // multiplied by the registers of each value
};

// An entry of `channels`. `point` has its name and origin.
MayFail read_wb_channel(const Node& channel, const WbBase& base, Point& point) {
  if (child(channel, "consists_of") != nullptr)
    return "one control of several registers; write a channel for each";
  std::string_view type = text_at(channel, "reg_type");
  if (type.empty()) type = "holding";
  const auto area = value_of(kWbAreas, type);
  if (!area) return fmt::format("register type '{}' is not of Modbus", type);
  point.access = can_be_written(*area) && bool_at(channel, "readonly") != true ? Access::kReadWrite
                                                                               : Access::kReadOnly;
  const auto address = address_of(channel, point);
  if (!address) return address.error();
  if (point.access == Access::kWriteOnly && !can_be_written(*area))
    return "a write address of an area that cannot be written";
  if (holds_bits(*area)) {
    point.type = ValueType::kBool;
  } else {
    if (auto fault = read_format(channel, point)) return fault;
    if (auto fault = read_register_part(*address, point)) return fault;
  }
  const std::uint64_t wide = holds_bits(*area) ? 1 : registers_of(point.type, point.string_bytes);
  point.at = address_text(*area, std::uint64_t{address->first} + base.shift + base.stride * wide,
                          point.bit);
  point.unit = point.type == ValueType::kBool ? std::string() : unit_of(channel);
  if (point.byte && point.access != Access::kReadOnly) {
    point.access = Access::kReadOnly;
    point.change("read only: half of a register");
  }
  if (auto fault = read_numbers(channel, point)) return fault;
  return read_switch(channel, point);
}

struct WbFile {
  const SourceText* source = nullptr;
  std::unique_ptr<config::Document> document;
  [[nodiscard]] const Node& root() const { return *document->root; }
};

class WbDeviceReader : TreeReader {
 public:
  WbDeviceReader(const WbFile& file, const Node& device, Found& found)
      : TreeReader(*file.source, found), device_(device) {}

  // `settings`: the device's entry in a configuration; may be nullptr.
  void read(Device& device, const Node* settings) {
    settings_ = settings;
    const bool of_template = settings != nullptr && settings != &device_;
    read_part(device_, device, {}, {}, of_template ? child(*settings, "channels") : nullptr, 0);
    tell_others();
  }

  // Skips channels of a configuration that only change settings of a template channel.
  void leave_out_those_of(const Node& template_device) {
    template_ = child(template_device, "channels");
  }

  void describe(Device& device) {
    // Shorter timeouts exclude the time of the line.
    device.timeout = milliseconds_from(text_at(device_, "response_timeout_ms"), 50, 60'001);
    if (const auto guard = number_at(device_, "guard_interval_us");
        guard && *guard > 0 && *guard <= 60e6)
      device.pause = std::chrono::microseconds{static_cast<std::int64_t>(*guard)};
    device.max_block = small_at(device_, "max_read_registers", 1, 124);
    device.max_gap = small_at(device_, "max_reg_hole", 0, 124);
    note_list("setup", "writes when the program starts");
    note_list("parameters", "settings");
  }

 private:
  void note_list(std::string_view key, std::string_view words) {
    const Node* list = child(device_, key);
    const std::size_t count =
        list == nullptr ? 0 : std::max(list->items.size(), list->entries.size());
    if (count > 0) found_.note("{}: {} {} of the device are not moved", source_.file, count, words);
  }

  using ByName = std::map<std::string_view, const Node*>;
  static ByName by_name(const Node* channels) {
    ByName named;
    for (const Node* channel : items_of(channels)) named[text_at(*channel, "name")] = channel;
    return named;
  }

  // `words`: channel settings of the configuration for this part.
  void read_part(const Node& part, Device& device, std::string_view prefix, const WbBase& base,
                 const Node* words, unsigned depth) {
    const ByName said_of = by_name(words), template_names = by_name(template_);
    for (const Node* channel : items_of(child(part, "channels"))) {
      std::string name(text_at(*channel, "name"));
      if (template_names.contains(name)) continue;
      const auto said = said_of.find(name);
      const Node* word = said == said_of.end() ? nullptr : said->second;
      if (!prefix.empty())
        name = name.empty() ? std::string(prefix) : fmt::format("{} {}", prefix, name);
      if (!text_at(*channel, "device_type").empty()) {
        read_sub_device(*channel, device, name, base, word, depth);
      } else {
        read_channel(*channel, device, std::move(name), base, word);
      }
    }
  }

  // Reads a part with several kinds as its default kind.
  void read_sub_device(const Node& channel, Device& device, const std::string& name,
                       const WbBase& base, const Node* word, unsigned depth) {
    if (depth == kMaxParts || ++parts_ > kMaxPartsRead)
      return refuse(channel, name, "parts in parts, too deep");
    const std::string_view kind = text_at(channel, "device_type");
    for (const Node* candidate : items_of(child(device_, "subdevices"))) {
      const Node* inner = child(*candidate, "device");
      const bool meant =
          text_at(*candidate, "title") == kind || text_at(*candidate, "device_type") == kind;
      if (!meant || inner == nullptr) continue;
      const auto more = [&](std::uint32_t first, std::string_view key) {
        return first + static_cast<std::uint32_t>(
                           std::min<std::uint64_t>(whole_at(channel, key).value_or(0), 65535));
      };
      return read_part(*inner, device, name,
                       {more(base.shift, "shift"), more(base.stride, "stride")},
                       word == nullptr ? nullptr : child(*word, "channels"), depth + 1);
    }
    refuse(channel, name, fmt::format("the part '{}' is not in the template", kind));
  }

  void read_channel(const Node& channel, Device& device, std::string name, const WbBase& base,
                    const Node* word) {
    Point point;
    // The first four keys only arrange the page.
    other_keys_.look(channel, "a channel",
                     "id title group order name reg_type address format write_address "
                     "string_data_size word_order byte_order scale offset round_to units type min "
                     "max error_value on_value off_value readonly enabled hidden condition "
                     "read_period_ms consists_of poll_interval read_rate_limit_ms");
    point.name = std::move(name);
    point.origin = origin_of(channel);
    if (auto fault = read_wb_channel(channel, base, point))
      return refuse(channel, point.name, std::move(*fault));
    if (word != nullptr && bool_at(*word, "readonly") == true &&
        point.access == Access::kReadWrite) {
      point.access = Access::kReadOnly;
      point.write_min.reset();
      point.write_max.reset();
    }
    for (const std::string_view key : {"read_period_ms", "read_rate_limit_ms", "poll_interval"}) {
      const bool own = word != nullptr && number_at(*word, key);
      if (const auto period = milliseconds_from(text_at(own ? *word : channel, key), 1, 8e7))
        point.refresh = period;
    }
    read_presence(channel, word, point);
    device.points.push_back(std::move(point));
  }

  // Makes disabled channels on-demand. The configuration overrides the template.
  void read_presence(const Node& channel, const Node* word, Point& point) const {
    const std::string_view condition = text_at(channel, "condition");
    const auto said = word == nullptr ? std::nullopt : bool_at(*word, "enabled");
    const bool hidden = bool_at(channel, "hidden") == true;  // read, but not shown
    const bool on = said.value_or(bool_at(channel, "enabled") != false) || hidden;
    if (!on && point.access != Access::kWriteOnly) {
      point.on_demand = true;
      point.change("off in the {}: read by command only",
                   said || settings_ == &device_ ? "configuration" : "template");
    }
    if (condition.empty()) return;
    const auto holds =
        condition_holds(condition, [this](std::string_view name) { return parameter(name); });
    if (holds == true || point.on_demand) return;
    if (point.access != Access::kWriteOnly) point.on_demand = true;
    point.change(
        "read by command only: the device has it where {}, and that is not its usual setting",
        condition);
  }

  [[nodiscard]] std::optional<double> parameter(std::string_view name) const {
    if (settings_ != nullptr) {
      if (const auto set = number_at(*settings_, name)) return set;
    }
    const Node* parameters = child(device_, "parameters");
    if (parameters == nullptr) return std::nullopt;
    if (const Node* one = child(*parameters, name)) return number_at(*one, "default");
    for (const Node* one : items_of(parameters)) {
      if (text_at(*one, "id") == name) return number_at(*one, "default");
    }
    return std::nullopt;
  }

  const Node& device_;
  const Node* settings_ = nullptr;
  const Node* template_ = nullptr;  // channels of the template
  unsigned parts_ = 0;
};

class WbReader {
 public:
  explicit WbReader(Found& found) : found_(found) {}

  void read(const std::vector<WbFile>& files) {
    for (const WbFile& file : files) {
      if (const Node* device = child(file.root(), "device"))
        templates_[std::string(text_at(file.root(), "device_type"))] = {&file, device};
    }
    bool configured = false;
    for (const WbFile& file : files) {
      const Node* ports = child(file.root(), "ports");
      if (!is_list(ports)) continue;
      configured = true;
      for (const Node* port : ports->items) read_port(file, *port);
    }
    if (configured) return;
    Bus bus;
    for (const WbFile& file : files) {
      if (const Node* device = child(file.root(), "device")) read_template(file, *device, bus);
    }
    found_.buses.push_back(std::move(bus));
  }

 private:
  struct Template {
    const WbFile* file = nullptr;
    const Node* device = nullptr;
  };

  void refuse(const WbFile& file, const Node& at, std::string_view name, std::string reason) {
    found_.refuse(name, {file.source->file, line_of(at)}, std::move(reason));
  }

  bool is_modbus(const WbFile& file, const Node& device) {
    const std::string_view protocol = text_at(device, "protocol");
    if (protocol.empty() || is_one_of(protocol, "modbus modbus-tcp")) return true;
    refuse(file, device, text_at(device, "name"),
           fmt::format("its protocol {} is not Modbus", protocol));
    return false;
  }

  void read_template(const WbFile& file, const Node& node, Bus& bus) {
    if (!is_modbus(file, node)) return;
    Device device;
    device.name = stem_of(file.source->file);
    if (device.name.starts_with("config-")) device.name.erase(0, 7);
    device.description = text_at(node, "name");
    WbDeviceReader reader(file, node, found_);
    reader.describe(device);
    reader.read(device, nullptr);
    bus.devices.push_back(std::move(device));
  }

  void read_port(const WbFile& file, const Node& node) {
    Bus bus;
    bus.origin = {file.source->file, line_of(node)};
    if (bool_at(node, "enabled") == false)
      return refuse(file, node, first_text(node, {"path", "address"}),
                    "the port is off (\"enabled\": false), with what is on it");
    if (!text_at(node, "address").empty()) {
      bus.port.tcp = tcp_at(node, "address", "port");
      bus.protocol = text_at(node, "port_type") == "modbus tcp" ? "modbus-tcp" : "modbus-rtu";
    } else {
      bus.port.serial = text_at(node, "path");
      bus.protocol = "modbus-rtu";
      bus.port.line = line_at(node, {"baud_rate", "data_bits", "parity", "stop_bits"});
      bus.port.usual = {9600, "wb-mqtt-serial"};
    }
    const Node* devices = child(node, "devices");
    if (!is_list(devices)) return;
    for (const Node* device : devices->items) read_device(file, *device, bus);
    found_.buses.push_back(std::move(bus));
  }

  void read_device(const WbFile& file, const Node& node, Bus& bus) {
    Device device;
    const std::string_view type = text_at(node, "device_type");
    device.name = first_text(node, {"name", "id", "device_type"});
    if (bool_at(node, "enabled") == false)
      return refuse(file, node, device.name, "the device is off (\"enabled\": false)");
    device.origin = {file.source->file, line_of(node)};
    if (const Slave slave = slave_from(text_at(node, "slave_id"))) {
      device.address = *slave;
    } else {
      device.fault = slave.error();
    }
    const Node* of_template = nullptr;
    if (!type.empty()) {
      const auto known = templates_.find(type);
      if (known == templates_.end())
        return refuse(file, node, device.name,
                      fmt::format("its template is not among the files: give the one with "
                                  "\"device_type\": \"{}\", too",
                                  type));
      if (!is_modbus(*known->second.file, *known->second.device)) return;
      of_template = known->second.device;
      WbDeviceReader reader(*known->second.file, *of_template, found_);
      reader.describe(device);
      reader.read(device, &node);
    }
    if (is_modbus(file, node)) {
      WbDeviceReader own(file, node, found_);
      if (of_template != nullptr) own.leave_out_those_of(*of_template);
      if (type.empty()) own.describe(device);
      own.read(device, &node);
    }
    bus.devices.push_back(std::move(device));
  }

  Found& found_;
  std::map<std::string, Template, std::less<>> templates_;
};

Confidence recognise_wb(const SourceText& source) {
  return confidence_by(source.text, {{R"("device_type" "channels" "device")", kCertain},
                                     {R"("ports" "devices" "slave_id")", kLikely},
                                     {R"("reg_type" "channels")", kLikely}});
}

Read read_wb(Sources sources, const ReadOptions&) {
  Found found;
  std::vector<WbFile> files;
  for (const SourceText& source : sources) {
    auto tree = read_json(source.text);
    if (tree) {
      files.push_back({&source, std::move(*tree)});
      continue;
    }
    const bool jinja = contains(source.text, "{%") || contains(source.text, "{{");
    found.refuse(stem_of(source.file), {source.file, 1},
                 jinja ? "a Jinja template, no JSON yet: `make templates` of wb-mqtt-serial "
                         "makes it, and installed systems have it made"
                       : tree.error());
  }
  WbReader(found).read(files);
  return found;
}

}  // namespace

constinit const Format kWbFormat{"wb-mqtt-serial",
                                 "wb-mqtt-serial template or configuration (JSON)", recognise_wb,
                                 read_wb, "0"};

}  // namespace fieldcast::importing
