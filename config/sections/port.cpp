#include "config/sections/port.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "config/document/baud.hpp"
#include "config/document/common_forms.hpp"
#include "config/document/limits.hpp"
#include "config/document/map_reader.hpp"
#include "config/document/scalars.hpp"
#include "config/sections/program.hpp"
#include "core/base/message_text.hpp"
#include "core/protocol/families/registry.hpp"

namespace fieldcast::config {

LineFormat factory_line(std::string_view protocol) {
  const ProtocolEntry* entry = find_protocol(protocol);
  return entry == nullptr ? LineFormat{} : entry->factory_line;
}

namespace {

struct FormatRule {
  std::optional<LineFormat> operator()(const Node& node, std::string_view key,
                                       FaultList& faults) const {
    static constexpr std::string_view kForm =
        "data bits 7 or 8, parity N, E or O, stop bits 1 or 2, such as 8E1";
    const std::string* text = scalar_of(node, key, kForm, faults);
    if (text == nullptr) return std::nullopt;
    const auto format = format_from(*text);
    if (format) return format;
    std::string upper;  // without separators, as in 8-n-1 or 8/N/1
    for (const char c : *text) {
      if (std::string_view(" -/,.").find(c) != std::string_view::npos) continue;
      upper += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    }
    faults.add(node.position, fmt::format("format '{}' is unknown", *text), kForm,
               format_from(upper) ? upper : "");
    return std::nullopt;
  }

  [[nodiscard]] static std::string schema() {
    return R"({ "type": ["string", "number"], "pattern": "^[78][NEO][12]$" })";
  }
  [[nodiscard]] static std::string form() { return {}; }
};

constexpr std::size_t kMaxServerName = 253;

DurationRule connect_timeout() { return {std::chrono::milliseconds{10}, kMaxTimeout}; }

constexpr std::pair<std::string_view, Fence> kFences[] = {{"none", Fence::kNone},
                                                          {"listen", Fence::kListen},
                                                          {"lock", Fence::kLock},
                                                          {"one-client", Fence::kOneClient}};
// The lower limit must exceed the delay of an adapter (16 ms).
DurationRule hold_time() { return {std::chrono::milliseconds{50}, std::chrono::seconds{5}}; }

// `fits`: valid fences of this port type.
FenceSpec read_fence(MapReader& map, std::initializer_list<Fence> fits, std::string_view allowed) {
  FenceSpec fence;
  Fence kind{};
  if (map.read("fence", kind, ChoiceRule<Fence>{kFences})) {
    fence.kind = kind;
    if (std::ranges::find(fits, kind) == fits.end()) {
      map.fault("fence", fmt::format("'fence: {}' does not fit this port", to_text(kind)), allowed);
    }
  }
  const bool held = map.read("hold", fence.hold, hold_time());
  if (held && !fence.is(Fence::kListen)) map.fault("hold", "'hold' without 'fence: listen'");
  return fence;
}

// Baud rate and format of a line that this bridge sets.
LineFormat read_line(MapReader& map, const LineFormat& factory) {
  LineFormat line = factory;
  std::uint32_t baud = factory.baud;
  map.read("format", line, FormatRule{});
  map.read("baud", baud, BaudRule{});
  line.baud = baud;
  return line;
}

PortSpec read_serial(MapReader& map, const LineFormat& factory, Library&) {
  SerialPortSpec port;
  if (map.read("serial", port.path, TextRule{kMaxPath}) &&
      port.path.find('/') == std::string::npos) {
    map.fault("serial", fmt::format("'{}' is no path of a serial port", port.path),
              "a path such as /dev/ttyUSB0 or /dev/serial/by-id/..");
  }
  port.line = read_line(map, factory);
  map.read("rs485", port.rs485, FlagRule{});
  map.read("low-latency", port.low_latency, FlagRule{});
  map.read("exclusive", port.exclusive, FlagRule{});
  port.fence = read_fence(map, {Fence::kNone, Fence::kListen, Fence::kLock}, "listen, lock, none");
  if (port.fence.is(Fence::kLock) && !port.exclusive) {
    map.fault("fence", "'fence: lock' with 'exclusive: false'",
              "exclusive: true, which takes the lock");
  }
  return port;
}

// Empty if there is no serial line behind the network.
std::optional<LineFormat> read_far_line(MapReader& map, const LineFormat& factory) {
  LineFormat format = factory;
  std::uint32_t baud = 0;
  const bool has_format = map.read("format", format, FormatRule{});
  if (map.read("baud", baud, BaudRule{})) {
    format.baud = baud;
    return format;
  }
  if (has_format && !map.has("baud")) {
    map.fault("format", "'format' without 'baud'",
              "both for the line behind a serial server, none for a plain TCP device");
  }
  return std::nullopt;
}

PortSpec read_tcp(MapReader& map, const LineFormat& factory, Library&) {
  TcpPortSpec port;
  std::pair<std::string, std::uint16_t> endpoint;
  if (map.read("tcp", endpoint, HostPortRule{}))
    port.host = endpoint.first, port.port = endpoint.second;
  map.read("connect-timeout", port.connect_timeout, connect_timeout());
  port.line = read_far_line(map, factory);
  port.fence = port.line ? read_fence(map, {Fence::kNone, Fence::kListen, Fence::kOneClient},
                                      "one-client, listen, none")
                         : read_fence(map, {Fence::kNone, Fence::kOneClient},
                                      "one-client, none; listen with 'baud', for a serial line "
                                      "behind a serial server");
  return port;
}

PortSpec read_rfc2217(MapReader& map, const LineFormat& factory, Library&) {
  Rfc2217PortSpec port;
  std::pair<std::string, std::uint16_t> endpoint;
  if (map.read("rfc2217", endpoint, HostPortRule{}))
    port.host = endpoint.first, port.port = endpoint.second;
  map.read("connect-timeout", port.connect_timeout, connect_timeout());
  port.line = read_line(map, factory);
  port.fence = read_fence(map, {Fence::kNone, Fence::kListen, Fence::kOneClient},
                          "one-client, listen, none");
  return port;
}

PortSpec read_tls_port(MapReader& map, const LineFormat&, Library& library) {
  TcpPortSpec port;
  std::pair<std::string, std::uint16_t> endpoint;
  if (map.read("tls", endpoint, HostPortRule{"802"}))
    port.host = endpoint.first, port.port = endpoint.second;
  map.read("connect-timeout", port.connect_timeout, connect_timeout());
  map.read("server-name", port.server_name, TextRule{kMaxServerName});
  port.tls = read_tls(map, library);
  // read_tls() requires both with an authority.
  if (!map.has("authority"))
    map.fault("tls", "'tls' without 'authority'",
              "authority: a PEM file with who signs the certificate of the device, or with that "
              "certificate; certificate and key of the bridge");
  port.fence = read_fence(map, {Fence::kNone, Fence::kOneClient}, "one-client, none");
  return port;
}

PortSpec read_udp(MapReader& map, const LineFormat& factory, Library&) {
  TcpPortSpec port;
  port.datagrams = true;
  std::pair<std::string, std::uint16_t> endpoint;
  if (map.read("udp", endpoint, HostPortRule{}))
    port.host = endpoint.first, port.port = endpoint.second;
  port.line = read_far_line(map, factory);
  return port;
}

PortSpec read_dial_in(MapReader& map, const LineFormat& factory, Library&) {
  DialInPortSpec port;
  map.read("dial-in", port.number, DeviceNumberRule{});
  port.line = read_far_line(map, factory);
  return port;
}

// One row per port type: its key, its value, the other allowed keys.
struct PortType {
  std::string_view key, value;
  std::vector<std::string_view> takes;
  PortSpec (*read)(MapReader& map, const LineFormat& factory, Library& library);
};
const std::array<PortType, 6>& port_types() {
  static const std::array<PortType, 6> types{{
      {"serial",
       "PATH",
       {"baud", "format", "rs485", "low-latency", "exclusive", "fence", "hold"},
       read_serial},
      {"tcp", "HOST:PORT", {"baud", "format", "connect-timeout", "fence", "hold"}, read_tcp},
      {"tls",
       "HOST:PORT",
       {"authority", "certificate", "key", "revoked", "server-name", "connect-timeout", "fence"},
       read_tls_port},
      {"udp", "HOST:PORT", {"baud", "format"}, read_udp},
      {"rfc2217",
       "HOST:PORT",
       {"baud", "format", "connect-timeout", "fence", "hold"},
       read_rfc2217},
      {"dial-in", "NUMBER", {"baud", "format"}, read_dial_in},
  }};
  return types;
}

std::vector<std::string_view> type_keys() {
  std::vector<std::string_view> keys;
  for (const PortType& type : port_types()) keys.push_back(type.key);
  return keys;
}

// "serial nor tcp nor udp nor rfc2217 nor dial-in".
std::string joined_with(std::string_view word) {
  std::string text;
  for (const auto key : type_keys()) {
    if (!text.empty()) text.append(word);
    text += key;
  }
  return text;
}

// "serial: PATH, tcp: HOST:PORT".
std::string examples(std::string_view before, std::string_view after, std::string_view between,
                     std::string_view last) {
  std::string text;
  const auto& types = port_types();
  for (std::size_t i = 0; i < types.size(); ++i) {
    if (i != 0) text.append(i + 1 == types.size() ? last : between);
    text.append(before).append(types[i].key).append(": ").append(types[i].value).append(after);
  }
  return text;
}

// Reads the keys of the type; keys of other types are faults.
PortSpec read_type(const PortType& type, MapReader& map, const LineFormat& factory,
                   Library& library) {
  for (const std::string_view key : port_rows().keys) {
    if (std::ranges::find(type.takes, key) != type.takes.end()) continue;
    const bool names_a_type =
        std::ranges::find(port_types(), key, &PortType::key) != port_types().end();
    if (map.find(key) == nullptr || names_a_type) continue;
    map.fault(key, fmt::format("'{}' has no meaning for a {} port", key, type.key));
  }
  return type.read(map, factory, library);
}

}  // namespace

std::optional<std::pair<std::string, std::uint16_t>> HostPortRule::operator()(
    const Node& node, std::string_view key, FaultList& faults) const {
  const std::string* text = scalar_of(node, key, "HOST:PORT", faults);
  if (text == nullptr) return std::nullopt;
  auto endpoint = host_port_from(*text);
  if (!endpoint) {
    const bool host_alone = !text->empty() && text->find(':') == std::string::npos;
    faults.add(node.position, fmt::format("{} '{}' names no host and port", key, *text),
               "HOST:PORT with a port 1 to 65535",
               host_alone && !port.empty() ? fmt::format("{}:{}", *text, port) : "");
  }
  return endpoint;
}

std::string HostPortRule::schema() const {
  return R"({ "type": "string", "pattern": "^.+:[0-9]{1,5}$" })";
}
std::string HostPortRule::form() const { return "`HOST:PORT`"; }

void check_port(const std::string& protocol, const PortSpec& port, const Position& position,
                FaultList& faults) {
  const ProtocolEntry* entry = find_protocol(protocol);
  if (entry == nullptr) return;
  const std::string instead(entry->instead);
  const bool serial =
      std::holds_alternative<SerialPortSpec>(port) || std::holds_alternative<Rfc2217PortSpec>(port);
  if (entry->network_only && serial)
    faults.add(position, protocol + " over a serial port", "port: { tcp: HOST:PORT }", instead);
  if (entry->whole_bytes && line_of(port).data_bits != 8) {
    faults.add(position, protocol + " over a line of 7 data bits", "format: 8E1, 8N2, 8O1, 8N1",
               instead);
  }
}

const RowTable& port_rows() {
  using Row = Field<PortSpec>;
  const auto row = [](Key key, const auto& rule) {
    if (key.schema.empty()) key.schema = rule.schema();
    if (key.form.empty()) key.form = rule.form();
    return Row{std::move(key), {}};
  };
  static const Rows<PortSpec> rows(
      "port", "'port'",
      {
          {{.name = "serial",
            .text = "path of a serial port; `/dev/serial/by-id/...` stays the same when adapters "
                    "move",
            .schema = R"({ "type": "string", "minLength": 1 })"}},
          row({.name = "tcp", .text = "of a TCP device or a serial server"}, HostPortRule{}),
          row({.name = "tls",
               .text = "of a device that speaks Modbus TCP inside TLS (MODBUS/TCP Security, port "
                       "802)"},
              HostPortRule{}),
          row({.name = "udp", .text = "of a device whose frames are datagrams"}, HostPortRule{}),
          row({.name = "rfc2217",
               .text =
                   "of a serial server that speaks RFC 2217; the bridge sets `baud` and `format` "
                   "of its line"},
              HostPortRule{}),
          row({.name = "dial-in",
               .text = "device number of a module that dials in (`program`, `modules`)"},
              DeviceNumberRule{}),
          row({"baud", factory_bauds(),
               "with `tcp`, `udp` or `dial-in`: of the line behind a serial server, so that its "
               "load can be planned; without it a plain TCP device"},
              BaudRule{}),
          row({"format", factory_formats(), "data bits, parity, stop bits: `8N1`, `7E2`"},
              FormatRule{}),
          row({"rs485", "false", "the kernel switches the direction of the line"}, FlagRule{}),
          row({"low-latency", "true", "asks the driver not to hold bytes back"}, FlagRule{}),
          row({"exclusive", "true", "nobody else may open the port"}, FlagRule{}),
          row({"connect-timeout", "3s", "with `tcp`, `tls` or `rfc2217`"}, connect_timeout()),
          row({.name = "authority",
               .text = "with `tls`: PEM file with who signs the certificate of the device, or with "
                       "that certificate"},
              TextRule{kMaxPath}),
          row({.name = "certificate",
               .text = "with `tls`: PEM file, by which the device knows the "
                       "bridge"},
              TextRule{kMaxPath}),
          row({.name = "key", .text = "with `tls`: PEM file of the certificate's private key"},
              TextRule{kMaxPath}),
          row({.name = "revoked", .text = "with `tls`: PEM file with revoked certificates (CRL)"},
              TextRule{kMaxPath}),
          row({"server-name", "HOST", "with `tls`: the name in the certificate of the device"},
              TextRule{kMaxServerName}),
          row({"fence", "not said",
               "what keeps a second master off the wire (docs/redundancy.md): `listen` "
               "before sending; `lock` of a serial port, for bridges on one host; "
               "`one-client`: a serial server that takes one connection"},
              ChoiceRule<Fence>{kFences}),
          row({"hold", "100ms", "with `fence: listen`: the longest pause between two requests"},
              hold_time()),
      },
      {}, type_keys());
  return rows;
}

std::string port_forms() { return "port: " + examples("{ ", " }", ", ", " or "); }

PortSpec read_port(const Node& node, const LineFormat& factory, Library& library,
                   FaultList& faults) {
  MapReader map(node, port_rows(), faults);
  std::vector<const PortType*> named;
  for (const PortType& type : port_types()) {
    if (map.has(type.key)) named.push_back(&type);
  }
  if (named.size() > 1) {
    map.fault(named[1]->key, fmt::format("a port is both {} and {}", named[0]->key, named[1]->key),
              "one of " + joined(type_keys()));
  }
  const bool means_one = std::ranges::any_of(
      port_types(), [&](const PortType& type) { return map.has_or_means(type.key); });
  if (map.is_map() && !means_one) {
    faults.add(map.position(), "'port' names neither " + joined_with(" nor "),
               examples("", "", ", ", ", "));
  }
  return read_type(named.empty() ? port_types().front() : *named.back(), map, factory, library);
}

}  // namespace fieldcast::config
