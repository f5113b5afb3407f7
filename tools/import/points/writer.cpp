#include "tools/import/points/writer.hpp"

#include <algorithm>

#include "core/base/value.hpp"
#include "tools/import/points/types.hpp"
#include "tools/import/text/text.hpp"

namespace fieldcast::importing {
namespace {

// Keys with one value for all channels of a device are written at the device.
struct SharedKeys {
  std::optional<Duration> refresh;
  WordOrder word_order = WordOrder::kBigEndian;
  ByteOrder byte_order = ByteOrder::kBigEndian;
};

// Word order matters for numbers of several registers, byte order also for text.
bool has_words(const Point& point) {
  return is_number(point.type) && registers_of(point.type, 0) > 1;
}
bool has_bytes(const Point& point) { return point.type != ValueType::kBool && !point.byte; }

// REQUIRES: the device has points.
SharedKeys shared_keys(const Device& device) {
  SharedKeys shared;
  const auto share = [&](auto& value, auto member, auto concerns) {
    const auto first = std::ranges::find_if(device.points, concerns);
    const bool same = std::ranges::all_of(device.points, [&](const Point& point) {
      return !concerns(point) || point.*member == (*first).*member;
    });
    if (first != device.points.end() && same) value = (*first).*member;
  };
  share(shared.refresh, &Point::refresh, [](const Point&) { return true; });
  share(shared.word_order, &Point::word_order, has_words);
  share(shared.byte_order, &Point::byte_order, has_bytes);
  return shared;
}

struct ChannelKey {
  std::string_view map;  // "limits" or "write" for nested keys
  std::string_view key, column;
  std::optional<std::string> value;  // empty: not written
};

std::vector<ChannelKey> keys_of(const Point& point, const SharedKeys& shared) {
  using Text = std::optional<std::string>;
  const auto when = [](bool used, std::string_view text) { return used ? Text(text) : Text(); };
  const auto number = [](const std::optional<double>& value) {
    return value ? Text(number_text(*value)) : Text();
  };
  const auto factor = [](double value, double usual) {
    return value == usual ? Text() : Text(number_text(value));
  };
  const auto order = [](bool little) { return little ? "little-endian" : "big-endian"; };
  const auto plain = [](std::string_view key, Text value) {
    return ChannelKey{{}, key, key, std::move(value)};
  };
  const bool own_words = has_words(point) && point.word_order != shared.word_order;
  const bool own_bytes = has_bytes(point) && point.byte_order != shared.byte_order;
  const bool own_refresh = point.refresh && point.refresh != shared.refresh;
  return {plain("name", point.name),
          plain("at", point.at),
          plain("type", type_text(point)),
          plain("byte", when(point.byte.has_value(), point.byte == 0 ? "low" : "high")),
          plain("word-order", when(own_words, order(point.word_order == WordOrder::kLittleEndian))),
          plain("byte-order", when(own_bytes, order(point.byte_order == ByteOrder::kLittleEndian))),
          plain("scale", factor(point.scale, 1)),
          plain("offset", factor(point.offset, 0)),
          plain("unit", when(!point.unit.empty(), point.unit)),
          plain("refresh", own_refresh ? Text(to_text(*point.refresh)) : Text()),
          plain("mode", when(point.on_demand, "on-demand")),
          plain("access", when(point.access != Access::kReadOnly, to_text(point.access))),
          plain("deadband", number(point.deadband)),
          {"limits", "low-low", "low-low", number(point.low_low)},
          {"limits", "low", "low", number(point.low)},
          {"limits", "high", "high", number(point.high)},
          {"limits", "high-high", "high-high", number(point.high_high)},
          {"limits", "hysteresis", "hysteresis", number(point.hysteresis)},
          {"write", "min", "write-min", number(point.write_min)},
          {"write", "max", "write-max", number(point.write_max)},
          plain("description", when(!point.description.empty(), point.description))};
}

// "{ name: power, at: "holding:10", type: float32 }"
std::string yaml_channel(const Point& point, const SharedKeys& shared) {
  std::string text = "{ ";
  std::string_view map;
  for (const auto& [key_map, key, column, value] : keys_of(point, shared)) {
    if (!value) continue;
    if (key_map != map && !map.empty()) text += " }";
    if (text.size() > 2) text += ", ";
    if (key_map != map && !key_map.empty()) text += fmt::format("{}: {{ ", key_map);
    map = key_map;
    const bool is_text = is_one_of(key, "at unit description name");
    text += fmt::format("{}: {}", key, is_text ? yaml_text(*value) : *value);
  }
  return text + (map.empty() ? " }" : " } }");
}

std::string csv_cell(std::string_view text) {
  const bool plain = text.find_first_of("\",;\t\n\r") == std::string_view::npos &&
                     !text.starts_with(' ') && !text.ends_with(' ') && !text.starts_with('#');
  if (plain) return std::string(text);
  constexpr Replacement kEscapes[] = {{"\"", "\"\""}, {"\n", " "}, {"\r", " "}};
  return fmt::format("\"{}\"", with_replaced(text, kEscapes));
}

bool is_word(std::string_view text) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  if (text.empty() || !letter(text[0])) return false;
  if (is_one_of(lower(text), "true false yes no on off null y n")) return false;
  return std::ranges::all_of(text, [&](char c) {
    return letter(c) || is_digit(c) || std::string_view("-_.()/").find(c) != std::string_view::npos;
  });
}

class LineWriter {
 public:
  void line(std::string_view text) {
    text_ += text;
    text_ += '\n';
    ++lines_;
  }
  void comment(std::string_view text) {
    while (!text.empty()) {
      const std::size_t end = text.find('\n');
      const std::string_view part = text.substr(0, end);
      line(part.empty() ? "#" : fmt::format("# {}", part));
      text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    }
  }
  [[nodiscard]] unsigned lines() const { return lines_; }
  [[nodiscard]] std::string take() { return std::move(text_); }

 private:
  std::string text_;
  unsigned lines_ = 0;
};

void write_channels(LineWriter& out, const Device& device, const SharedKeys& shared,
                    std::string_view indent, WrittenPart where, WrittenFile& file) {
  for (where.point = 0; where.point < device.points.size(); ++where.point) {
    out.line(fmt::format("{}- {}", indent, yaml_channel(device.points[where.point], shared)));
    where.first = where.last = out.lines();
    file.parts.push_back(where);
  }
}

std::vector<std::string> device_lines(const Device& device, const SharedKeys& shared) {
  std::vector<std::string> lines;
  const auto add = [&](std::string_view key, const auto& value) {
    lines.push_back(fmt::format("{}: {}", key, value));
  };
  if (shared.refresh) add("refresh", to_text(*shared.refresh));
  if (shared.word_order != WordOrder::kBigEndian) add("word-order", "little-endian");
  if (shared.byte_order != ByteOrder::kBigEndian) add("byte-order", "little-endian");
  if (device.timeout) add("timeout", to_text(*device.timeout));
  if (device.pause) add("pause", to_text(*device.pause));
  if (device.retries) add("retries", *device.retries);
  if (device.max_block) add("max-block", *device.max_block);
  if (device.max_gap) add("max-gap", *device.max_gap);
  return lines;
}

constexpr std::string_view kWriteMultiple = "options: { write-single: multiple }";

WrittenFile channel_list(const Device& device, const SharedKeys& shared, WrittenPart where) {
  WrittenFile file;
  LineWriter out;
  std::vector<ChannelKey> used = keys_of(device.points.front(), shared);
  for (const Point& point : device.points) {
    const auto keys = keys_of(point, shared);
    for (std::size_t i = 0; i < keys.size(); ++i) {
      if (keys[i].value) used[i].value.emplace();
    }
  }
  const auto write_row = [&](auto&& cell_of) {
    std::vector<std::string> cells;
    for (std::size_t i = 0; i < used.size(); ++i) {
      if (used[i].value) cells.push_back(cell_of(i));
    }
    out.line(fmt::format("{}", fmt::join(cells, ",")));
  };
  write_row([&](std::size_t i) { return std::string(used[i].column); });
  for (where.point = 0; where.point < device.points.size(); ++where.point) {
    const auto keys = keys_of(device.points[where.point], shared);
    write_row([&](std::size_t i) { return csv_cell(keys[i].value.value_or("")); });
    where.first = where.last = out.lines();
    file.parts.push_back(where);
  }
  file.text = out.take();
  return file;
}

class ConfigurationWriter {
 public:
  explicit ConfigurationWriter(const WriteOptions& options) : options_(options) {}

  std::vector<WrittenFile> write(const std::vector<Bus>& buses) {
    files_.emplace_back().name = options_.file;
    out_.comment(options_.head);
    out_.line(fmt::format("bridge: {}", yaml_text(options_.bridge)));
    out_.line(
        "dds: { domain: 0, interfaces: [127.0.0.1] }  # this machine only, unless you open it");
    out_.line("buses:");
    for (std::size_t i = 0; i < buses.size(); ++i) {
      const Bus& bus = buses[i];
      WrittenPart head{.first = out_.lines() + 1, .bus = i};
      out_.line(fmt::format("  - name: {}", yaml_text(bus.name)));
      out_.line(fmt::format("    port: {{ {} }}", port_text(bus.port)));
      out_.line(fmt::format("    protocol: {}", bus.protocol));
      out_.line("    devices:");
      add_part(head);
      for (std::size_t k = 0; k < bus.devices.size(); ++k) write_device(bus, i, k);
    }
    files_.front().text = out_.take();
    return std::move(files_);
  }

 private:
  void write_device(const Bus& bus, std::size_t bus_index, std::size_t index) {
    const Device& device = bus.devices[index];
    const SharedKeys shared = shared_keys(device);
    WrittenPart where{.first = out_.lines() + 1, .bus = bus_index, .device = index};
    out_.line(fmt::format("      - name: {}", yaml_text(device.name)));
    out_.line(fmt::format("        address: {}", device.address.value_or(1)));
    for (const std::string& line : device_lines(device, shared)) out_.line("        " + line);
    if (device.write_multiple) out_.line(fmt::format("        {}", kWriteMultiple));
    if (!options_.lists) {
      out_.line("        channels:");
      add_part(where);
      return write_channels(out_, device, shared, "          ", where, files_.front());
    }
    WrittenFile list = channel_list(device, shared, where);
    list.name = fmt::format("{}-{}.csv", bus.name, device.name);
    out_.line(fmt::format("        channels: {}", yaml_text(list.name)));
    add_part(where);
    files_.push_back(std::move(list));
  }

  void add_part(WrittenPart part) {
    part.last = out_.lines();
    files_.front().parts.push_back(part);
  }

  const WriteOptions& options_;
  LineWriter out_;
  std::vector<WrittenFile> files_;
};

}  // namespace

std::string type_text(const Point& point) {
  if (point.type == ValueType::kString) return fmt::format("string({})", point.string_bytes);
  return std::string(to_text(point.type));
}

std::string yaml_text(std::string_view text) {
  if (is_word(text)) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    const auto byte = static_cast<unsigned char>(c);
    quoted += byte < 0x20 ? fmt::format("\\x{:02X}", byte) : std::string(1, c);
  }
  return quoted + '"';
}

std::string port_text(const Port& port) {
  std::string text =
      port.tcp.empty() ? "serial: " + yaml_text(port.serial) : "tcp: " + yaml_text(port.tcp);
  if (port.line.baud) text += fmt::format(", baud: {}", *port.line.baud);
  if (!port.line.format.empty()) text += fmt::format(", format: {}", port.line.format);
  return text;
}

std::vector<WrittenFile> write_configuration(const std::vector<Bus>& buses,
                                             const WriteOptions& options) {
  return ConfigurationWriter(options).write(buses);
}

WrittenFile write_template(const Device& device, std::string_view head) {
  const SharedKeys shared = shared_keys(device);
  WrittenFile file;
  LineWriter out;
  out.comment(head);
  if (!device.description.empty())
    out.line(fmt::format("description: {}", yaml_text(device.description)));
  out.line("protocols: [modbus-rtu, modbus-ascii, modbus-tcp]");
  const auto lines = device_lines(device, shared);
  if (!lines.empty()) out.line("defaults:");
  for (const std::string& line : lines) out.line("  " + line);
  if (device.write_multiple) out.line(kWriteMultiple);
  out.line("channels:");
  file.parts.push_back({.first = 1, .last = out.lines(), .device = 0});
  write_channels(out, device, shared, "  ", {.device = 0}, file);
  file.text = out.take();
  return file;
}

}  // namespace fieldcast::importing
