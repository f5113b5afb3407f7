#include "tools/import/points/writer.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/value.hpp"
#include "tools/import/points/channel_keys.hpp"

namespace fieldcast::importing {
namespace {

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
                    std::string_view indent, WrittenChannel where, WrittenFile& file) {
  for (where.point = 0; where.point < device.points.size(); ++where.point) {
    out.line(fmt::format("{}- {}", indent, yaml_channel(device.points[where.point], shared)));
    where.line = out.lines();
    file.channels.push_back(where);
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

WrittenFile channel_list(const Device& device, const SharedKeys& shared, WrittenChannel where) {
  WrittenFile file;
  LineWriter out;
  const std::vector<std::string> columns = csv_columns(device, shared);
  out.line(fmt::format("{}", fmt::join(columns, ",")));
  for (where.point = 0; where.point < device.points.size(); ++where.point) {
    out.line(csv_row(device.points[where.point], shared, columns));
    where.line = out.lines();
    file.channels.push_back(where);
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
      WrittenHead head{.first = out_.lines() + 1, .bus = i};
      out_.line(fmt::format("  - name: {}", yaml_text(bus.name)));
      out_.line(fmt::format("    port: {{ {} }}", port_text(bus.port)));
      out_.line(fmt::format("    protocol: {}", bus.protocol));
      out_.line("    devices:");
      head.last = out_.lines();
      files_.front().heads.push_back(head);
      for (std::size_t k = 0; k < bus.devices.size(); ++k) write_device(bus, i, k);
    }
    files_.front().text = out_.take();
    return std::move(files_);
  }

 private:
  void write_device(const Bus& bus, std::size_t bus_index, std::size_t index) {
    const Device& device = bus.devices[index];
    const SharedKeys shared = shared_keys(device);
    const WrittenChannel where{.bus = bus_index, .device = index};
    WrittenHead head{.first = out_.lines() + 1, .bus = bus_index, .device = index};
    out_.line(fmt::format("      - name: {}", yaml_text(device.name)));
    out_.line(fmt::format("        address: {}", device.address.value_or(1)));
    for (const std::string& line : device_lines(device, shared)) out_.line("        " + line);
    if (device.write_multiple) out_.line(fmt::format("        {}", kWriteMultiple));
    if (!options_.lists) {
      out_.line("        channels:");
      head.last = out_.lines();
      files_.front().heads.push_back(head);
      write_channels(out_, device, shared, "          ", where, files_.front());
      return;
    }
    WrittenFile list = channel_list(device, shared, where);
    list.name = fmt::format("{}-{}.csv", bus.name, device.name);
    out_.line(fmt::format("        channels: {}", yaml_text(list.name)));
    head.last = out_.lines();
    files_.front().heads.push_back(head);
    files_.push_back(std::move(list));
  }

  const WriteOptions& options_;
  LineWriter out_;
  std::vector<WrittenFile> files_;
};

}  // namespace

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
  file.heads.push_back({.first = 1, .last = out.lines(), .device = 0});
  write_channels(out, device, shared, "  ", {}, file);
  file.text = out.take();
  return file;
}

}  // namespace fieldcast::importing
