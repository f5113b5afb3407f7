#include "config/sections/gateway.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "config/document/document.hpp"
#include "config/document/limits.hpp"
#include "config/document/scalars.hpp"
#include "config/sections/program.hpp"

namespace fieldcast::config {

namespace {

constexpr std::pair<std::string_view, bool> kAccess[] = {{"read", false}, {"write", true}};
constexpr Duration kMaxAge = std::chrono::hours{1};
constexpr Duration kMinWait = std::chrono::milliseconds{10}, kMaxWait = std::chrono::minutes{1};
constexpr Duration kMinClientIdle = std::chrono::seconds{1},
                   kMaxClientIdle = std::chrono::hours{24};
constexpr double kMaxShare = 0.5;
constexpr std::uint16_t kMaxConnections = 256;
constexpr std::string_view kUnitsForm = "units 0 to 255 and names of devices: { 1: press-1 }";

bool is_modbus(const DeviceSpec& device) {
  return !device.declaration && device.protocol.starts_with("modbus-");
}

void read_units(MapReader& map, const BusSpec& spec, GatewaySpec& gateway) {
  const Node* node = map.find("units");
  if (node == nullptr) return;
  if (node->kind != Kind::kMap || node->entries.empty())
    return map.fault("units", "units is " + std::string(to_text(node->kind)), kUnitsForm);
  std::vector<std::string_view> names;
  for (const DeviceSpec& device : spec.devices) names.push_back(device.name);
  for (const Node::Entry& entry : node->entries) {
    const auto unit = WholeRule{0, 255}(*entry.key, "unit", map.faults());
    const std::string* name = scalar_of(*entry.value, entry.key->text, kUnitsForm, map.faults());
    if (!unit || name == nullptr) continue;
    if (std::ranges::find(names, *name) == names.end())
      map.faults().add(entry.value->position, fmt::format("the bus has no device '{}'", *name),
                       joined(names), closest(*name, names));
    gateway.units.emplace(static_cast<std::uint8_t>(*unit), *name);
  }
}

}  // namespace

const Rows<GatewaySpec>& gateway_rows() {
  static const Rows<GatewaySpec> rows(
      "gateway", "'gateway' of a bus",
      {
          field({.name = "listen",
                 .fallback = "needed",
                 .text = "`ADDRESS:PORT` of this machine. Modbus TCP has no login: off the "
                         "loopback, `clients` is needed",
                 .example = "listen: 127.0.0.1:1502"},
                &GatewaySpec::listen, ListenRule{1502}),
          field({"access", "read",
                 "`write` also permits functions 5, 6, 15 and 16, to devices with `allow: "
                 "[raw-write]`"},
                &GatewaySpec::writes, ChoiceRule<bool>{kAccess}),
          field({"verify", "false", "each write is read back before its response"},
                &GatewaySpec::verify, FlagRule{}),
          {{.name = "units",
            .fallback = "each device at its address",
            .text = "the device of each unit that clients may use",
            .schema = R"({ "type": "object", "additionalProperties": )"
                      R"({ "$ref": "#/$defs/word" } })",
            .form = "`{ 1: press-1, 2: press-2 }`"}},
          {{.name = "clients",
            .fallback = "the loopback",
            .text = "addresses and networks of the clients: `[10.0.7.0/24]`",
            .schema = R"({ "type": "array", "minItems": 1, "maxItems": )" +
                      std::to_string(kMaxInterfaces) +
                      R"(, "items": { "type": "string", "minLength": 1 } })"}},
          field({"max-age", "500ms",
                 "a response of the device that is at most this old also serves a later request "
                 "for its items; `0ms`: only a response to a request that was sent afterwards"},
                &GatewaySpec::max_age, DurationRule{Duration{}, kMaxAge}),
          field({"share", "0",
                 "part of the wire that clients get even if refreshes are then missed; 0: only "
                 "what the plan leaves"},
                &GatewaySpec::share, NumberRule{0, kMaxShare}),
          field({"timeout", "1s", "until a request that found no time on the wire is refused"},
                &GatewaySpec::timeout, DurationRule{kMinWait, kMaxWait}),
          field({"idle", "60s", "until a client without requests is disconnected"},
                &GatewaySpec::idle, DurationRule{kMinClientIdle, kMaxClientIdle}),
          field({"connections", "32",
                 "of clients at the same time; a further one displaces the one that has been "
                 "silent longest"},
                &GatewaySpec::connections, WholeRule{1, kMaxConnections}),
      },
      "Modbus TCP clients read and write the devices of the bus: "
      "[docs/gateway.md](../docs/gateway.md).");
  return rows;
}

void read_gateway(MapReader& bus, BusSpec& spec) {
  const Node* node = bus.find("gateway");
  if (node == nullptr) return;
  MapReader map(*node, gateway_rows(), bus.faults());
  GatewaySpec& gateway = spec.gateway.emplace();
  gateway_rows().read(map, gateway);
  read_units(map, spec, gateway);
  read_networks(map, "clients", gateway.clients);
  if (gateway.clients.empty() && !map.has("clients") && !gateway.listen.host.empty() &&
      !on_loopback(gateway.listen))
    map.fault("listen", "a gateway off the loopback, and no client is permitted",
              "clients: [10.0.7.0/24], or an address 127.0.0.1");
  const auto named = [&](const DeviceSpec& device) {
    return gateway.units.empty() || std::ranges::any_of(gateway.units, [&](const auto& unit) {
             return unit.second == device.name;
           });
  };
  for (const DeviceSpec& device : spec.devices) {
    if (!named(device) || is_modbus(device) || device.protocol.empty()) continue;
    return bus.fault("gateway",
                     fmt::format("device '{}' has protocol {}", device.name, device.protocol),
                     "a gateway for devices with modbus-rtu, modbus-ascii or modbus-tcp; select "
                     "them with units");
  }
  if (gateway.writes && std::ranges::none_of(spec.devices, [&](const DeviceSpec& device) {
        return named(device) && device.allow_raw_write;
      }))
    map.fault("access", "access: write, and no device permits it",
              "allow: [raw-write] at a device");
}

}  // namespace fieldcast::config
