#include "tools/import/arrange.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "config/document/limits.hpp"
#include "core/base/value.hpp"
#include "core/model/port_spec.hpp"
#include "core/protocol/families/registry.hpp"
#include "tools/import/points/names.hpp"
#include "tools/import/points/types.hpp"

namespace fieldcast::importing {
namespace {

constexpr std::string_view kGuessedPort = "/dev/ttyUSB0";

bool same_port(const Port& a, const Port& b) { return a.serial == b.serial && a.tcp == b.tcp; }

// A port can be opened only once, so its devices belong to one bus.
void merge_buses(std::vector<Bus>& buses) {
  std::vector<Bus> merged;
  for (Bus& bus : buses) {
    const auto known = std::ranges::find_if(merged, [&](const Bus& other) {
      return same_port(other.port, bus.port) && other.protocol == bus.protocol;
    });
    if (known == merged.end()) {
      merged.push_back(std::move(bus));
      continue;
    }
    std::ranges::move(bus.devices, std::back_inserter(known->devices));
    if (!known->port.line.baud) known->port.line = bus.port.line;
  }
  buses = std::move(merged);
}

void merge_devices(Bus& bus) {
  std::vector<Device> merged;
  for (Device& device : bus.devices) {
    const auto known =
        device.address ? std::ranges::find(merged, device.address, &Device::address) : merged.end();
    if (known == merged.end()) {
      merged.push_back(std::move(device));
    } else {
      std::ranges::move(device.points, std::back_inserter(known->points));
    }
  }
  bus.devices = std::move(merged);
}

// Sets the port of buses without one, and of a single bus. Returns true if it was guessed.
bool set_ports(std::vector<Bus>& buses, const ImportOptions& options, Found& found) {
  const bool said = !options.port.serial.empty() || !options.port.tcp.empty();
  bool guessed = false;
  std::size_t own = 0;
  for (Bus& bus : buses) {
    const bool none = bus.port.serial.empty() && bus.port.tcp.empty();
    own += !none && buses.size() > 1;
    if (said && (none || buses.size() == 1)) {
      const Port listed = std::exchange(bus.port, options.port);
      if (!bus.port.line.baud) bus.port.line.baud = listed.line.baud;
      if (bus.port.line.format.empty()) bus.port.line.format = listed.line.format;
      bus.port.usual = listed.usual;
    } else if (none) {
      guessed = true;
      bus.port.serial = kGuessedPort;
      bus.port.line = options.port.line;
    }
    if (!options.protocol.empty()) bus.protocol = options.protocol;
    if (bus.protocol.empty()) bus.protocol = bus.port.tcp.empty() ? "modbus-rtu" : "modbus-tcp";
    if (!bus.port.tcp.empty() && bus.protocol == "modbus-tcp") bus.port.line = {};
  }
  if (guessed && !options.as_template)
    found.note(
        "the list says no port: {} is a guess; say --port, and --baud, --format of a "
        "serial line",
        kGuessedPort);
  if (said && own > 0)
    found.note("{} buses keep the port that their files name; --port is that of the others", own);
  return guessed;
}

// Usual line of Modbus devices, which differs from the loader's standard; else the factory setting.
Line line_of_family(std::string_view protocol) {
  const ProtocolEntry* entry = find_protocol(protocol);
  if (entry == nullptr || protocol == "modbus-rtu") return {9600, "8N1"};
  const std::string text = to_text(entry->factory_line);  // "9600 8E1"
  return {entry->factory_line.baud, text.substr(text.find(' ') + 1)};
}

void fill_line(Bus& bus, bool tell, Found& found) {
  Port& port = bus.port;
  if (port.serial.empty() || (port.line.baud && !port.line.format.empty())) return;
  const Line family = line_of_family(bus.protocol);
  const std::string_view missing = !port.line.baud ? "baud rate" : "format of the line";
  const bool program = !port.line.baud && port.usual.baud != 0;
  if (!port.line.baud) port.line.baud = program ? port.usual.baud : family.baud;
  if (port.line.format.empty()) port.line.format = family.format;
  if (!tell) return;
  found.note("{}: the list says no {}: {} {} is taken{}{}; --port, --baud, --format say another",
             port.serial, missing, *port.line.baud, port.line.format,
             program ? ", the baud rate of " : "", program ? port.usual.program : "");
}

void set_addresses(Bus& bus, const ImportOptions& options, Found& found) {
  std::set<std::uint16_t> taken;
  for (const Device& device : bus.devices) {
    if (device.address) taken.insert(*device.address);
  }
  auto next = static_cast<std::uint16_t>(options.address.value_or(1));
  for (Device& device : bus.devices) {
    if (device.address) continue;
    while (taken.contains(next)) ++next;
    device.address = next;
    taken.insert(next);
    if (!options.address && !options.as_template)
      found.note("device '{}': the list says no address on the bus: {} is a guess; say --address",
                 device.name, next);
  }
}

void forget_buses(std::vector<Bus>& buses) {
  for (std::size_t i = 1; i < buses.size(); ++i)
    std::ranges::move(buses[i].devices, std::back_inserter(buses[0].devices));
  if (buses.size() > 1) buses.resize(1);
  for (Bus& bus : buses) {
    for (Device& device : bus.devices) device.address.reset();
  }
}

// A cell of a spreadsheet may have several lines; a text of the configuration has one.
void join_lines(std::string& text) {
  std::ranges::replace_if(
      text, [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
}

void name_points(Device& device) {
  join_lines(device.description);
  UniqueNames names;
  for (Point& point : device.points) {
    std::string name = plain_name(point.name);
    // An empty name is replaced by the address and kept as the description.
    const bool lost = name.empty();
    if (lost) name = plain_name(point.at);
    const bool foreign = lost || std::ranges::any_of(point.name, [](char c) {
                           return static_cast<unsigned char>(c) >= 0x80;
                         });
    if (foreign && point.description.empty()) point.description = point.name;
    join_lines(point.unit);
    join_lines(point.description);
    if (point.unit.size() > config::kMaxUnit) {
      point.unit = cut_text(point.unit, config::kMaxUnit);
      point.change("the unit is cut");
    }
    if (point.description.size() > config::kMaxDescription) {
      point.description = cut_text(point.description, config::kMaxDescription);
      point.change("the description is cut");
    }
    std::string unique = names.unique(name);
    if (unique != name) point.change("the name '{}' stands more than once", point.name);
    point.listed = std::exchange(point.name, std::move(unique));
  }
}

void set_names(std::vector<Bus>& buses, const ImportOptions& options) {
  UniqueNames bus_names;
  for (Bus& bus : buses) {
    std::string name =
        plain_name(buses.size() == 1 && !options.bus.empty() ? options.bus : bus.name);
    if (name.empty())
      name = buses.size() == 1 ? "bus-1" : fmt::format("bus-{}", &bus - &buses[0] + 1);
    bus.name = bus_names.unique(std::move(name));
    UniqueNames device_names;
    for (Device& device : bus.devices) {
      const bool alone = buses.size() == 1 && bus.devices.size() == 1;
      std::string own = plain_name(alone && !options.device.empty() ? options.device : device.name);
      if (own.empty()) own = fmt::format("device-{}", device.address.value_or(1));
      device.name = device_names.unique(std::move(own));
      name_points(device);
      for (Point& point : device.points) {
        if (options.refresh && !point.on_demand) point.refresh = options.refresh;
      }
    }
  }
}

// The configuration has no scale for bits and texts; dropping the scale would change the value.
MayFail fault_of_scale(const Point& point) {
  if (is_number(point.type) || (point.scale == 1 && point.offset == 0)) return std::nullopt;
  const std::string has =
      fmt::format("scale {}, offset {}", number_text(point.scale), number_text(point.offset));
  if (point.type == ValueType::kString) return fmt::format("a text has no scale ({})", has);
  if (point.scale == -1 && point.offset == 1)
    return fmt::format(
        "the list inverts this bit ({}), and a channel is always true at 1: take scale and offset "
        "out of the list and invert the bit where it is used",
        has);
  return fmt::format("a bit has no scale ({})", has);
}

void refuse_faulty(Found& found) {
  for (Bus& bus : found.buses) {
    for (Device& device : bus.devices) {
      std::erase_if(device.points, [&](const Point& point) {
        const auto fault = fault_of_scale(point);
        if (fault) found.refuse(point.name, point.origin, *fault);
        return fault.has_value();
      });
      if (!bus.fault.empty()) {
        refuse_device(device, "its bus", bus.origin, bus.fault, found.refusals);
      } else if (!device.fault.empty()) {
        refuse_device(device, "its device", device.origin, device.fault, found.refusals);
      }
    }
  }
}

}  // namespace

std::string reason_of(const config::Fault& fault) {
  return fault.allowed.empty() ? fault.what : fault.what + "; allowed: " + fault.allowed;
}

void drop_empty(Found& found) {
  for (Bus& bus : found.buses)
    std::erase_if(bus.devices, [](const Device& device) { return device.points.empty(); });
  std::erase_if(found.buses, [](const Bus& bus) { return bus.devices.empty(); });
}

void refuse_device(Device& device, std::string_view whose, const Origin& where,
                   const std::string& reason, std::vector<Refusal>& refusals) {
  const std::string place = where.line == 0 ? "" : fmt::format(" ({}:{})", where.file, where.line);
  const std::string words = fmt::format("{}{}: {}", whose, place, reason);
  for (const Point& point : device.points)
    refusals.push_back({point.listed.empty() ? point.name : point.listed, point.origin, words});
  device.points.clear();
}

void arrange(Found& found, const ImportOptions& options) {
  refuse_faulty(found);
  drop_empty(found);
  const bool guessed = set_ports(found.buses, options, found);
  merge_buses(found.buses);
  for (Bus& bus : found.buses) merge_devices(bus);
  // A guessed port has been reported with its line settings.
  for (Bus& bus : found.buses)
    fill_line(bus, !options.as_template && !(guessed && bus.port.serial == kGuessedPort), found);
  if (options.as_template) forget_buses(found.buses);
  for (Bus& bus : found.buses) set_addresses(bus, options, found);
  set_names(found.buses, options);
}

}  // namespace fieldcast::importing
