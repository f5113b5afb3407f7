#include "config/port.hpp"

#include <algorithm>
#include <array>

#include "config/limits.hpp"
#include "config/map_reader.hpp"
#include "config/program.hpp"
#include "config/scalars.hpp"
#include "core/base/near_miss.hpp"
#include "core/protocol/registry.hpp"

namespace fieldcast::config {
namespace {

// What termios names (termios(3), B50 .. B4000000), from the slowest that a PLC speaks, and what
// PLCs speak besides: 93750 and 187500 are rates of S7-200's PPI, the others come from dividers of
// common crystals.
constexpr std::array<std::uint32_t, 29> kBauds{
    300,    600,    1200,   1800,    2400,    4800,    9600,    14400,   19200,  28800,
    38400,  57600,  76800,  93750,   115200,  125000,  187500,  230400,  250000, 460800,
    500000, 576000, 921600, 1000000, 1152000, 1500000, 2000000, 3000000, 4000000};

std::string baud_list() {
  std::string text;
  for (const auto baud : kBauds) text += (text.empty() ? "" : ", ") + std::to_string(baud);
  return text;
}

// What the protocol's devices speak as they come from the factory; of other protocols the default
// of LineFormat.
LineFormat factory_line(std::string_view protocol) {
  const ProtocolEntry* entry = find_protocol(protocol);
  return entry == nullptr ? LineFormat{} : entry->factory_line;
}

struct BaudRule {
  std::optional<std::uint32_t> operator()(const Node& node, std::string_view key,
                                          FaultList& faults) const {
    const auto value = WholeRule{1, kBauds.back()}(node, key, faults);
    if (!value) return std::nullopt;
    const auto baud = static_cast<std::uint32_t>(*value);
    if (std::ranges::find(kBauds, baud) != kBauds.end()) return baud;
    faults.add(node.place, "baud " + std::to_string(baud) + " is no rate of serial ports",
               baud_list(), likely_bauds(baud));
    return std::nullopt;
  }

  // A slip of the hand (a digit too many, another digit), and the nearest of those in daily use.
  static std::string likely_bauds(std::uint32_t baud) {
    static constexpr std::array<std::uint32_t, 10> kUsual{1200,  2400,  4800,   9600,   19200,
                                                          38400, 57600, 115200, 230400, 460800};
    std::vector<std::string> usual;
    for (const auto rate : kUsual) usual.push_back(std::to_string(rate));
    const auto slip = near_miss(std::to_string(baud), usual);
    const auto ratio = [&](std::uint32_t rate) {
      return std::max(rate, baud) / static_cast<double>(std::min(rate, baud));
    };
    const auto near = *std::ranges::min_element(kUsual, {}, ratio);
    std::string text = slip;
    if (ratio(near) < 1.25 && std::to_string(near) != slip)
      text += (text.empty() ? "" : " or ") + std::to_string(near);
    return text;
  }
};

struct FormatRule {
  std::optional<LineFormat> operator()(const Node& node, std::string_view key,
                                       FaultList& faults) const {
    static constexpr std::string_view kForm =
        "data bits 7 or 8, parity N, E or O, stop bits 1 or 2, such as 8E1";
    const std::string* text = scalar_of(node, key, kForm, faults);
    if (text == nullptr) return std::nullopt;
    const auto format = format_from(*text);
    if (format) return format;
    std::string upper;  // without what others put between the three: 8-n-1, 8/N/1
    for (const char c : *text) {
      if (std::string_view(" -/,.").find(c) != std::string_view::npos) continue;
      upper += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    }
    faults.add(node.place, "format '" + *text + "' is unknown", std::string(kForm),
               format_from(upper) ? upper : "");
    return std::nullopt;
  }
};

struct HostPortRule {
  std::optional<std::pair<std::string, std::uint16_t>> operator()(const Node& node,
                                                                  std::string_view key,
                                                                  FaultList& faults) const {
    const std::string* text = scalar_of(node, key, "HOST:PORT", faults);
    if (text == nullptr) return std::nullopt;
    auto endpoint = host_port_from(*text);
    if (!endpoint) {
      const bool host_alone = !text->empty() && text->find(':') == std::string::npos;
      faults.add(node.place, std::string(key) + " '" + *text + "' names no host and port",
                 "HOST:PORT with a port 1 to 65535", host_alone ? *text + ":502" : "");
    }
    return endpoint;
  }
};

// Keys that belong to another kind of port.
void refuse(MapReader& map, std::string_view kind, std::span<const std::string_view> keys) {
  for (const auto key : keys) {
    if (map.find(key) == nullptr) continue;
    map.faults().add(map.place_of(key), "'" + std::string(key) + "' has no meaning for a " +
                                            std::string(kind) + " port");
  }
}

SerialPortSpec read_serial(MapReader& map, const LineFormat& standard) {
  SerialPortSpec port;
  std::uint32_t baud = standard.baud;
  port.line = standard;
  map.read("serial", port.path, TextRule{kMaxPath});
  map.read("format", port.line, FormatRule{});
  map.read("baud", baud, BaudRule{});
  port.line.baud = baud;
  map.read("rs485", port.rs485, FlagRule{});
  map.read("low-latency", port.low_latency, FlagRule{});
  map.read("exclusive", port.exclusive, FlagRule{});
  refuse(map, "serial", std::array<std::string_view, 1>{"connect-timeout"});
  return port;
}

// Of the serial line behind a network; nothing where there is none.
std::optional<LineFormat> read_far_line(MapReader& map, const LineFormat& standard) {
  LineFormat format = standard;
  std::uint32_t baud = 0;
  const bool has_format = map.read("format", format, FormatRule{});
  if (map.read("baud", baud, BaudRule{})) {
    format.baud = baud;
    return format;
  }
  if (has_format && !map.has("baud")) {
    map.faults().add(map.place_of("format"), "'format' without 'baud'",
                     "both for the line behind a serial server, none for a plain TCP device");
  }
  return std::nullopt;
}

TcpPortSpec read_tcp(MapReader& map, const LineFormat& standard) {
  TcpPortSpec port;
  std::pair<std::string, std::uint16_t> endpoint;
  if (map.read("tcp", endpoint, HostPortRule{}))
    port.host = endpoint.first, port.port = endpoint.second;
  map.read("connect-timeout", port.connect_timeout,
           DurationRule{std::chrono::milliseconds{10}, kMaxTimeout});
  port.line = read_far_line(map, standard);
  refuse(map, "tcp", std::array<std::string_view, 3>{"rs485", "low-latency", "exclusive"});
  return port;
}

DialInPortSpec read_dial_in(MapReader& map, const LineFormat& standard) {
  DialInPortSpec port;
  map.read("dial-in", port.number, DeviceNumberRule{});
  port.line = read_far_line(map, standard);
  refuse(map, "dial-in",
         std::array<std::string_view, 4>{"rs485", "low-latency", "exclusive", "connect-timeout"});
  return port;
}

}  // namespace

std::optional<LineFormat> format_from(std::string_view text) {
  if (text.size() != 3 || (text[0] != '7' && text[0] != '8') || (text[2] != '1' && text[2] != '2'))
    return std::nullopt;
  LineFormat format;
  format.data_bits = static_cast<std::uint8_t>(text[0] - '0');
  format.stop_bits = static_cast<std::uint8_t>(text[2] - '0');
  switch (text[1]) {
    case 'N': format.parity = Parity::kNone; return format;
    case 'E': format.parity = Parity::kEven; return format;
    case 'O': format.parity = Parity::kOdd; return format;
    default: return std::nullopt;
  }
}

std::optional<std::pair<std::string, std::uint16_t>> host_port_from(std::string_view text) {
  const auto colon = text.rfind(':');
  if (colon == std::string_view::npos || colon == 0) return std::nullopt;
  std::string_view host = text.substr(0, colon);
  const auto port = whole_from(text.substr(colon + 1));
  if (!port || *port < 1 || *port > 65535 || text.substr(colon + 1).starts_with("0x"))
    return std::nullopt;
  const bool bracketed = host.starts_with('[') && host.ends_with(']');
  if (bracketed) host = host.substr(1, host.size() - 2);
  if (host.empty() || host.size() > 253 || (!bracketed && host.find(':') != std::string_view::npos))
    return std::nullopt;
  for (const char c : host) {
    const bool fits = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                      c == '.' || c == '-' || c == '_' || (bracketed && (c == ':' || c == '%'));
    if (!fits) return std::nullopt;
  }
  return std::pair{std::string(host), static_cast<std::uint16_t>(*port)};
}

void check_port(const std::string& protocol, const PortSpec& port, const Place& place,
                FaultList& faults) {
  const ProtocolEntry* entry = find_protocol(protocol);
  if (entry == nullptr) return;
  const std::string instead(entry->instead);
  if (entry->network_only && std::holds_alternative<SerialPortSpec>(port))
    faults.add(place, protocol + " over a serial port", "port: { tcp: HOST:PORT }", instead);
  if (entry->whole_bytes && line_of(port).data_bits != 8) {
    faults.add(place, protocol + " over a line of 7 data bits", "format: 8E1, 8N2, 8O1, 8N1",
               instead);
  }
}

PortSpec read_port(const Node& node, std::string_view protocol, FaultList& faults) {
  const LineFormat standard = factory_line(protocol);
  MapReader map(node, kPortKeys, faults);
  (void)map.find("serial");
  const Node* tcp = map.find("tcp");
  const Node* dial_in = map.find("dial-in");
  static constexpr std::string_view kKinds[] = {"serial", "tcp", "dial-in"};
  std::vector<std::string_view> named;
  for (const auto kind : kKinds) {
    if (map.has(kind)) named.push_back(kind);
  }
  if (named.size() > 1) {
    faults.add(map.place_of(named[1]),
               "a port is both " + std::string(named[0]) + " and " + std::string(named[1]),
               "one of " + joined(kKinds));
  }
  const bool means_one =
      std::ranges::any_of(kKinds, [&](auto kind) { return map.has_or_means(kind); });
  if (map.is_map() && !means_one) {
    faults.add(map.place(), "'port' names neither serial nor tcp nor dial-in",
               "serial: PATH, tcp: HOST:PORT, dial-in: NUMBER");
  }
  if (dial_in != nullptr && named.front() == "dial-in") return read_dial_in(map, standard);
  if (tcp != nullptr || map.has("tcp")) return read_tcp(map, standard);
  return read_serial(map, standard);
}

}  // namespace fieldcast::config
