#include "config/sections/gateway.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "config/document/document.hpp"
#include "config/document/limits.hpp"
#include "config/document/scalars.hpp"
#include "config/sections/program.hpp"
#include "core/model/fit.hpp"
#include "core/protocol/families/registry.hpp"

namespace fieldcast::config {

namespace {

constexpr std::pair<std::string_view, bool> kAccess[] = {{"read", false}, {"write", true}};
constexpr Duration kMaxAge = std::chrono::hours{1};
constexpr Duration kMinWait = std::chrono::milliseconds{10}, kMaxWait = std::chrono::minutes{1};
constexpr Duration kMinClientIdle = std::chrono::seconds{1},
                   kMaxClientIdle = std::chrono::hours{24};
constexpr double kMaxShare = 0.5;
constexpr std::uint16_t kMaxConnections = 256;
constexpr std::size_t kMaxGatewayRows = 1000;
constexpr std::pair<std::string_view, ValueType> kRegisterTypes[] = {
    {"uint16", ValueType::kUint16},   {"int16", ValueType::kInt16},
    {"uint32", ValueType::kUint32},   {"int32", ValueType::kInt32},
    {"uint64", ValueType::kUint64},   {"int64", ValueType::kInt64},
    {"float32", ValueType::kFloat32}, {"float64", ValueType::kFloat64}};
constexpr std::string_view kMapForm =
    "names of devices and their rows: { plc-1: [ { registers: 0, at: DB10.DBW0, count: 50 } ] }";
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

// A row of `map` with its place in the file.
struct PlacedRow {
  GatewayRow row;
  Position position;
};

// Checks the addresses of the device, from the first value to the last one.
void check_values(MapReader& map, const GatewayRow& row, const Protocol& protocol) {
  const auto address = protocol.parse_address(row.at);
  if (!address)
    return map.fault("at", address.error().what, address.error().allowed,
                     address.error().suggestion);
  const Area& area = protocol.areas()[address->area];
  const Encoding encoding = with_form_of(*address, {.type = row.type});
  if (const auto misfit = check_fit(row.at, *address, area, encoding))
    return map.fault("at", misfit->what, misfit->allowed, misfit->suggestion);
  const std::uint64_t values = row.count;
  const std::uint64_t items = address->bit && area.item_bits > 1
                                  ? (*address->bit + values - 1) / area.item_bits + 1
                                  : item_count(encoding, area.item_bits) * values;
  if (address->first + items > area.items || (is_field(*address) && values > 1))
    map.fault("count",
              fmt::format("{} values from '{}' on reach beyond the {}", values, row.at,
                          is_field(*address) ? "field" : "area"),
              is_field(*address) ? "count: 1" : "fewer values");
}

void check_overlaps(const std::vector<PlacedRow>& placed, FaultList& faults) {
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const GatewayRow& row = placed[i].row;
    for (std::size_t j = 0; j < i; ++j) {
      const GatewayRow& other = placed[j].row;
      if (other.bits == row.bits && row.first < other.end() && other.first < row.end())
        return faults.add(
            placed[i].position,
            fmt::format("{} {} is in two rows of the map", row.bits ? "bit" : "register",
                        std::max(row.first, other.first)),
            "rows that do not overlap");
    }
  }
}

std::vector<GatewayRow> read_rows(const Node& list, const DeviceSpec& device, const BusSpec& bus,
                                  FaultList& faults) {
  if (!is_list(list, device.name, 1, kMaxGatewayRows, "a list of rows", faults)) return {};
  const auto protocol = make_protocol(device, line_of(bus.port));
  std::vector<GatewayRow> rows;
  std::vector<PlacedRow> placed;
  for (const Node* node : list.items) {
    MapReader map(*node, gateway_row_rows(), faults);
    GatewayRow row;
    gateway_row_rows().read(map, row);
    row.bits = map.read("bits", row.first, WholeRule{0, 65535});
    map.read("registers", row.first, WholeRule{0, 65535});
    if (map.has("bits") == map.has("registers"))
      map.fault("registers", "a row has either bits or registers", "one of bits, registers");
    if (row.bits) {
      if (map.has("type")) map.fault("type", "bits have no type", "registers");
      row.type = ValueType::kBool;
    }
    if (row.end() > 65536)
      map.fault("count", fmt::format("the last {} is beyond 65535", row.bits ? "bit" : "register"),
                "fewer values");
    if (protocol && !row.at.empty()) check_values(map, row, **protocol);
    placed.push_back({row, node->position});
    rows.push_back(std::move(row));
  }
  check_overlaps(placed, faults);
  return rows;
}

void read_map(MapReader& map, const BusSpec& bus, GatewaySpec& gateway) {
  const Node* node = map.find("map");
  if (node == nullptr) return;
  if (node->kind != Kind::kMap || node->entries.empty())
    return map.fault("map", "map is " + std::string(to_text(node->kind)), kMapForm);
  std::vector<std::string_view> names;
  for (const DeviceSpec& device : bus.devices) names.push_back(device.name);
  for (const Node::Entry& entry : node->entries) {
    const auto device = std::ranges::find(bus.devices, entry.key->text, &DeviceSpec::name);
    if (device == bus.devices.end()) {
      map.faults().add(entry.key->position,
                       fmt::format("the bus has no device '{}'", entry.key->text), joined(names),
                       closest(entry.key->text, names));
      continue;
    }
    gateway.rows.emplace(device->name, read_rows(*entry.value, *device, bus, map.faults()));
  }
}

}  // namespace

const Rows<GatewayRow>& gateway_row_rows() {
  static const std::string address = WholeRule{0, 65535}.schema();
  static const Rows<GatewayRow> rows(
      "gateway-row", "a row of `map` in 'gateway'",
      {
          {{.name = "registers",
            .fallback = "this or bits",
            .text = "the first holding register and input register",
            .schema = address,
            .form = WholeRule{0, 65535}.form()}},
          {{.name = "bits",
            .fallback = "this or registers",
            .text = "the first coil and discrete input",
            .schema = address,
            .form = WholeRule{0, 65535}.form()}},
          field({.name = "at",
                 .fallback = std::string(kNeeded),
                 .text = "address of the first value in the notation of the device",
                 .example = "at: DB10.DBW0"},
                &GatewayRow::at, TextRule{kMaxNameLength}),
          field({"type", "uint16",
                 "of a value in registers. A wider type occupies several registers, high word "
                 "first"},
                &GatewayRow::type, ChoiceRule<ValueType>{kRegisterTypes}),
          field({"count", "1", "number of consecutive values"}, &GatewayRow::count,
                WholeRule{1, 65536}),
      },
      "Consecutive values of a device as bits or registers of its unit.", {"registers", "bits"});
  return rows;
}

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
                 "`write` also permits functions 5, 6, 15, 16, 22 and 23, to devices with `allow: "
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
          {{.name = "map",
            .fallback = "the addresses of the device's own Modbus",
            .text = "for devices of other protocols: what the bits and registers of their units "
                    "are",
            .schema = R"({ "type": "object", "additionalProperties": { "type": "array", )"
                      R"("minItems": 1, "items": { "$ref": "#/$defs/gateway-row" } } })",
            .form = "`{ plc-1: [ { registers: 0, at: DB10.DBW0, count: 50 } ] }`"}},
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

// Without the key `units`, the address of a device is its unit.
void check_own_addresses(MapReader& map, const BusSpec& spec) {
  std::map<std::uint32_t, std::string_view> units;
  for (const DeviceSpec& device : spec.devices) {
    const auto [first, is_new] = units.emplace(device.link.address, device.name);
    if (!is_new || device.link.address > 0xFF)
      return map.fault("listen",
                       is_new
                           ? fmt::format("device '{}' has address {}, which is no unit of Modbus",
                                         device.name, device.link.address)
                           : fmt::format("devices '{}' and '{}' would both be unit {}",
                                         first->second, device.name, first->first),
                       "units: { 1: NAME OF A DEVICE, .. }");
  }
}

void read_gateway(MapReader& bus, BusSpec& spec) {
  const Node* node = bus.find("gateway");
  if (node == nullptr) return;
  MapReader map(*node, gateway_rows(), bus.faults());
  GatewaySpec& gateway = spec.gateway.emplace();
  gateway_rows().read(map, gateway);
  read_units(map, spec, gateway);
  read_map(map, spec, gateway);
  read_networks(map, "clients", gateway.clients);
  if (gateway.clients.empty() && !map.has("clients") && !gateway.listen.host.empty() &&
      !on_loopback(gateway.listen))
    map.fault("listen", "a gateway off the loopback, and no client is permitted",
              "clients: [10.0.7.0/24], or an address 127.0.0.1");
  if (!map.has("units")) check_own_addresses(map, spec);
  const auto named = [&](const DeviceSpec& device) {
    return gateway.units.empty() || std::ranges::any_of(gateway.units, [&](const auto& unit) {
             return unit.second == device.name;
           });
  };
  for (const DeviceSpec& device : spec.devices) {
    if (!named(device) || is_modbus(device) || device.protocol.empty() ||
        gateway.rows.contains(device.name))
      continue;
    return map.fault(
        "map",
        fmt::format("device '{}' has protocol {} and no rows in map", device.name, device.protocol),
        "rows for each device whose protocol is not Modbus, or only the others in "
        "units");
  }
  if (gateway.writes && std::ranges::none_of(spec.devices, [&](const DeviceSpec& device) {
        return named(device) && device.allow_raw_write;
      }))
    map.fault("access", "access: write, and no device permits it",
              "allow: [raw-write] at a device");
}

}  // namespace fieldcast::config
