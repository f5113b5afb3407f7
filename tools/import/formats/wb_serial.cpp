// wb-mqtt-serial: device templates, and configurations whose devices use them.
//
// Source: wirenboard/wb-mqtt-serial README.md, templates/.
#include <algorithm>
#include <map>

#include "tools/import/formats/expression.hpp"
#include "tools/import/formats/format.hpp"
#include "tools/import/formats/wb_channel.hpp"
#include "tools/import/points/address.hpp"

namespace fieldcast::importing {
namespace {

constexpr unsigned kMaxParts = 8;         // nesting depth of parts
constexpr unsigned kMaxPartsRead = 5000;  // of a device

struct WbFile {
  const SourceText* source = nullptr;
  std::unique_ptr<config::Document> document;
  [[nodiscard]] const Node& root() const { return *document->root; }
};

std::optional<Duration> milliseconds_at(const Node& map, std::string_view key) {
  const auto number = number_at(map, key);
  if (!number || *number <= 0 || *number > 60'000) return std::nullopt;
  return std::chrono::microseconds{static_cast<std::int64_t>(*number * 1000)};
}

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
    if (const auto timeout = milliseconds_at(device_, "response_timeout_ms");
        timeout && *timeout >= std::chrono::milliseconds{50})
      device.timeout = timeout;  // shorter timeouts exclude the time of the line
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
    if (count > 0)
      found_.notes.push_back(
          fmt::format("{}: {} {} of the device are not moved", source_.file, count, words));
  }

  // Of duplicates the last.
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
      auto period = number_at(channel, key);
      if (word != nullptr && number_at(*word, key)) period = number_at(*word, key);
      if (period && *period >= 1 && *period < 8e7)
        point.refresh = std::chrono::milliseconds{static_cast<std::int64_t>(*period)};
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
      point.changes.push_back(
          fmt::format("off in the {}: read by command only",
                      said || settings_ == &device_ ? "configuration" : "template"));
    }
    if (condition.empty()) return;
    const auto holds =
        condition_holds(condition, [this](std::string_view name) { return parameter(name); });
    if (holds == true || point.on_demand) return;
    if (point.access != Access::kWriteOnly) point.on_demand = true;
    point.changes.push_back(fmt::format(
        "read by command only: the device has it where {}, and that is not its usual setting",
        condition));
  }

  // From the configuration, or the template's default.
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
    found_.refusals.push_back(
        {std::string(name), {file.source->file, line_of(at)}, std::move(reason)});
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
    if (const auto address = text_at(node, "address"); !address.empty()) {
      bus.port.tcp = fmt::format("{}:{}", address, whole_at(node, "port").value_or(502));
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

bool is_jinja(std::string_view text) { return contains(text, "{%") || contains(text, "{{"); }

Confidence recognise_wb(const SourceText& source) {
  const std::string_view text = source.text;
  const auto has = [&](std::string_view word) { return contains(text, word); };
  if (has("\"device_type\"") && has("\"channels\"") && has("\"device\"")) return kCertain;
  if (has("\"ports\"") && has("\"devices\"") && has("\"slave_id\"")) return kLikely;
  return has("\"reg_type\"") && has("\"channels\"") ? kLikely : 0;
}

Read read_wb(std::span<const SourceText> sources, const ReadOptions&) {
  Found found;
  std::vector<WbFile> files;
  for (const SourceText& source : sources) {
    auto tree = read_json(source.text);
    if (tree) {
      files.push_back({&source, std::move(*tree)});
      continue;
    }
    found.refusals.push_back(
        {stem_of(source.file),
         {source.file, 1},
         is_jinja(source.text)
             ? "a Jinja template, no JSON yet: `make templates` of wb-mqtt-serial "
               "makes it, and installed systems have it made"
             : tree.error()});
  }
  WbReader(found).read(files);
  return found;
}

}  // namespace

constinit const Format kWbFormat{"wb-mqtt-serial",
                                 "wb-mqtt-serial template or configuration (JSON)", recognise_wb,
                                 read_wb, "0"};

}  // namespace fieldcast::importing
