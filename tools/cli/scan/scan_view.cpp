#include "tools/cli/scan/scan_view.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/protocol/device_code.hpp"
#include "tools/cli/model/address_notation.hpp"
#include "tools/cli/scan/sunspec_view.hpp"

namespace fieldcast::cli {
namespace {

std::string format_text(const LineFormat& format) {
  const std::string text = to_text(format);  // "9600 8N1"
  return text.substr(text.find(' ') + 1);
}

std::string response_text(const ScanLine& line, const ScanResponse& response) {
  if (response.cause == Cause::kNone) return "value";
  if (response.cause == Cause::kDeviceError || response.device_code != 0)
    return "refuses: " +
           device_code_words(scan_protocol(line.protocol)->traits().codes, response.device_code);
  return std::string(to_text(response.cause));
}

std::string comment_text(std::string_view text) {
  std::string line = printable(text);
  for (char& c : line) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  return line;
}

std::string identity_text(const ScanFound& found) {
  return found.identity.empty() && found.sunspec ? sunspec_identity(*found.sunspec)
                                                 : found.identity;
}

// "cpu: s7-200, tsap: 10.01"; with `quote` as in a configuration.
std::string options_text(const ScanLine& line, std::string_view quote = "") {
  std::string text;
  for (const auto& [name, value] : line.options)
    text += fmt::format("{}{}: {}{}{}", text.empty() ? "" : ", ", name, quote, value, quote);
  return text;
}

std::string type_of(const Protocol& protocol, const ScanQuestion& question) {
  return type_at(question.at, {}, protocol).value_or("uint16");
}

}  // namespace

std::string line_text(const ScanLine& line, bool serial) {
  const std::string name(line.protocol.name());
  if (serial) return name + ' ' + to_text(line.format);
  return line.options.empty() ? name : fmt::format("{} {{ {} }}", name, options_text(line));
}

ProgressText scan_progress(const Scanner& scanner, Duration elapsed, bool serial) {
  const auto ask = scanner.next();
  if (!ask) return {};
  const std::size_t all = scanner.asked() + scanner.left();
  ProgressText text = progress_text(
      "scanning", static_cast<double>(scanner.asked()) / static_cast<double>(all), elapsed);
  if (text.how_far.ends_with("left")) text.how_far += " at most";
  text.how_far += fmt::format(", {} found; {}, address {}", scanner.found().size(),
                              line_text(scanner.lines()[ask->line], serial), ask->address);
  return text;
}

std::vector<std::string> found_lines(const Scanner& scanner, bool serial, const Screen& screen) {
  TextTable table({{"ADDRESS", Align::kRight},
                   {"PROTOCOL AND LINE"},
                   {"RESPONSE"},
                   {"AFTER", Align::kRight},
                   {"WHAT IT SAYS OF ITSELF"}});
  for (const ScanFound& found : scanner.found()) {
    const ScanLine& line = scanner.lines()[found.line];
    table.add_row({{std::to_string(found.address)},
                   {line_text(line, serial)},
                   {response_text(line, found.response),
                    found.response.cause == Cause::kNone ? Tone::kGood : Tone::kPlain},
                   {fmt::format("{:.1f} ms", to_seconds(found.response.took) * 1e3)},
                   {comment_text(identity_text(found))}});
  }
  std::vector<std::string> lines = table.render(screen);
  for (const ScanFound& found : scanner.found()) {
    if (!found.sunspec) continue;
    for (const std::string& line : sunspec_lines(found.address, *found.sunspec))
      lines.push_back(comment_text(line));
  }
  return lines;
}

std::vector<std::string> template_lines(const Scanner& scanner) {
  std::vector<std::string> lines;
  for (const ScanFound& found : scanner.found()) {
    if (found.templates.empty()) continue;
    lines.push_back(
        fmt::format("address {}: template: {}", found.address, fmt::join(found.templates, " or ")));
  }
  if (!lines.empty())
    lines.emplace_back(
        "write `template: NAME` at the device in the configuration, or use --out FILE; then "
        "compare "
        "the values with the display");
  return lines;
}

std::vector<std::string> silence_lines(const std::string& port, const Scanner& scanner, bool serial,
                                       Duration timeout) {
  std::vector<std::pair<std::string, std::string>> rows;  // addresses, settings
  for (const ScanLine& line : scanner.lines()) {
    const auto [least, most] = std::ranges::minmax(line.probes);
    const std::string addresses =
        fmt::format("{} addresses from {} to {}", line.probes.size(), least, most);
    auto row = std::ranges::find(rows, addresses, [](const auto& each) { return each.first; });
    if (row == rows.end()) row = rows.insert(row, {addresses, ""});
    row->second += (row->second.empty() ? "" : ", ") + line_text(line, serial);
  }
  std::vector<std::string> lines{fmt::format("no byte was received on {}", printable(port))};
  for (const auto& [addresses, settings] : rows)
    lines.push_back(fmt::format("  {} were probed: {}", addresses, settings));
  lines.emplace_back(serial ? "check A and B (D+ and D-) of the line, its termination, the supply "
                              "of the device, its baud rate and format, and --protocol"
                            : "check the device behind the port, its address, and --protocol");
  lines.push_back(fmt::format(
      "--all requests every address twice at each setting and waits {:.0f} ms for each "
      "response; it takes about {}",
      to_seconds(timeout) * 1e3,
      to_text(
          std::chrono::ceil<std::chrono::seconds>(silent_scan_time(scanner.lines(), timeout)))));
  return lines;
}

Json found_json(const std::string& port, const ScanLine& line, const ScanFound& found,
                bool serial) {
  Json json{{"port", port}, {"protocol", line.protocol.name()}};
  if (serial) {
    json.add("baud", line.format.baud);
    json.add("format", format_text(line.format));
  }
  json.add("address", found.address);
  if (!line.options.empty()) json.add("options", line.options);
  json.add("answer",
           found.response.cause == Cause::kNone ? "value" : to_name(found.response.cause));
  json.add("device_code", found.response.device_code);
  json.add("answer_time", found.response.took.count());
  json.add("identity", found.identity);
  json.add("templates", found.templates);
  if (found.sunspec) json.add("sunspec", sunspec_json(*found.sunspec));
  return json;
}

std::string configuration_text(const std::string& port, bool serial, const Scanner& scanner,
                               bool server) {
  const ScanLine& line = scanner.lines()[scanner.found().front().line];
  const auto protocol = scan_protocol(line, line.addresses.front());
  const auto questions = questions_of(line.protocol, *protocol);
  std::string reached = fmt::format("{}: \"{}\"", serial ? "serial" : "tcp", port);
  if (serial || server)
    reached += fmt::format(", baud: {}, format: {}", line.format.baud, format_text(line.format));
  std::string text = fmt::format(
      "# Written by `fieldcast scan`. Replace the channels by those of your devices, look at the\n"
      "# file with `fieldcast-bridge --check FILE`, then start `fieldcast-bridge FILE`.\n"
      "bridge: bridge-1\n"
      "dds: {{ domain: 0, interfaces: [127.0.0.1] }}\n"
      "buses:\n"
      "  - name: bus-1\n"
      "    port: {{ {} }}\n"
      "    protocol: {}\n"
      "    devices:\n",
      reached, line.protocol.name());
  for (const ScanFound& found : scanner.found()) {
    if (questions.empty() || found.line != scanner.found().front().line) continue;
    const ScanQuestion& asked = questions[std::min(found.question, questions.size() - 1)];
    text +=
        fmt::format("      - name: device-{}\n        address: {}\n", found.address, found.address);
    if (!line.options.empty())
      text += fmt::format("        options: {{ {} }}\n", options_text(line, "\""));
    if (const std::string identity = identity_text(found); !identity.empty())
      text += fmt::format("        # it says: {}\n", comment_text(identity));
    if (found.response.cause != Cause::kNone)
      text += fmt::format("        # it responds, but {} {}\n", response_text(line, found.response),
                          asked.at);
    if (found.templates.size() == 1) {
      text += fmt::format("        template: {}\n", found.templates.front());
      continue;
    }
    for (const std::string& name : found.templates)
      text += fmt::format("        # may fit, in place of the channels: template: {}\n", name);
    std::vector<std::string> channels;
    if (found.sunspec) {
      text += sunspec_comment(*found.sunspec);
      channels = sunspec_channels(*found.sunspec);
    }
    if (channels.empty())
      channels = {fmt::format("{{ name: first, at: \"{}\", type: {}, refresh: 1s }}", asked.at,
                              type_of(*protocol, asked))};
    else
      text += "        refresh: 2s\n";
    text += "        channels:\n";
    for (const std::string& channel : channels) text += "          - " + channel + '\n';
  }
  return text;
}

}  // namespace fieldcast::cli
