#include "config/sections/program.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "config/document/limits.hpp"
#include "config/document/scalars.hpp"
#include "config/document/unique_names.hpp"
#include "config/sections/bridge_keys.hpp"
#include "config/sections/port.hpp"
#include "config/sections/program_access.hpp"
#include "core/program/frame.hpp"

namespace fieldcast::config {
namespace {

using program::RegistrationRule;

// `users`: a store with users exists.
void read_engineers(MapReader& program, ProgramSpec& spec, Library& library, bool users) {
  const Node* node = program.find("engineers");
  if (node == nullptr) return;
  MapReader map(*node, engineer_rows(), program.faults());
  EngineersSpec& engineers = spec.engineers.emplace();
  engineer_rows().read(map, engineers);
  engineers.tls = read_tls(map, library);
  check_engineers(map, engineers, users);
}

void read_modules(MapReader& program, ProgramSpec& spec, Library& library) {
  const Node* node = program.find("modules");
  if (node == nullptr) return;
  MapReader map(*node, module_rows(), program.faults());
  ModulesSpec& modules = spec.modules.emplace();
  module_rows().read(map, modules);
  read_module_access(map, modules, library);
  if (modules.registration.ask == RegistrationRule::Ask::kWords) return;
  for (const char* key : {"unit", "first", "words"}) {
    if (map.has(key))
      map.faults().add(map.position_of(key), fmt::format("'{}' has no meaning for ask: text", key),
                       "ask: words");
  }
}

const Node* value_of(const Node& map, std::string_view key) {
  for (const auto& [name, value] : map.entries) {
    if (name->text == key) return value;
  }
  return nullptr;
}

}  // namespace

std::optional<ListenSpec> ListenRule::operator()(const Node& node, std::string_view key,
                                                 FaultList& faults) const {
  const std::string form =
      fmt::format("ADDRESS:PORT of this machine, such as 127.0.0.1:{0} or [::1]:{0}", usual_port);
  const std::string* text = scalar_of(node, key, form, faults);
  if (text == nullptr) return std::nullopt;
  const auto endpoint = host_port_from(*text);
  const bool address =
      endpoint && (is_ipv4(endpoint->first) || endpoint->first.find(':') != std::string::npos);
  if (address) return ListenSpec{endpoint->first, endpoint->second};
  const bool local = endpoint && endpoint->first == "localhost";
  faults.add(node.position, fmt::format("{} '{}' is no address and port", key, *text), form,
             local ? fmt::format("127.0.0.1:{}", endpoint->second) : "");
  return std::nullopt;
}

std::string ListenRule::schema() const {
  return R"({ "type": "string", )"
         R"("pattern": "^([0-9]{1,3}(\\.[0-9]{1,3}){3}|\\[[0-9a-fA-F:%.]+\\]):[0-9]{1,5}$" })";
}
std::string ListenRule::form() const { return {}; }

std::string DeviceNumberRule::schema() const {
  return R"({ "type": ["string", "integer"], "pattern": "^[A-Za-z0-9]{1,16}$" })";
}
std::string DeviceNumberRule::form() const { return "1 to 16 letters or digits"; }

std::optional<std::string> DeviceNumberRule::operator()(const Node& node, std::string_view key,
                                                        FaultList& faults) const {
  const std::string* text = scalar_of(node, key, program::kDeviceNumberForm, faults);
  if (text == nullptr) return std::nullopt;
  if (program::is_device_number(*text)) return *text;
  faults.add(node.position, fmt::format("{} '{}' is no device number", key, *text),
             std::string(program::kDeviceNumberForm));
  return std::nullopt;
}

void read_program(MapReader& bridge, ProgramSpec& spec, Library& library) {
  const Node* node = bridge.find("program");
  if (node == nullptr) return;
  MapReader map(*node, program_rows(), bridge.faults());
  read_engineers(map, spec, library, bridge.has("store"));
  read_modules(map, spec, library);
  if (spec.engineers && spec.modules && spec.engineers->listen == spec.modules->listen &&
      spec.modules->listen.port != 0) {
    bridge.faults().add(map.position_of("modules"), "modules and engineers listen at the same port",
                        "a port of its own for each");
  }
}

void check_device_numbers(const Node& buses, const BridgeSpec& spec, FaultList& faults) {
  UniqueNames numbers;
  for (std::size_t i = 0; i < std::min(buses.items.size(), spec.buses.size()); ++i) {
    const Node& bus = *buses.items[i];
    const Node* port = value_of(bus, "port");
    if (const auto* dial_in = std::get_if<DialInPortSpec>(&spec.buses[i].port);
        dial_in && port && !dial_in->number.empty()) {
      const Node* number = value_of(*port, "dial-in");
      const Position& position = number ? number->position : port->position;
      numbers.add("device number", dial_in->number, position, faults);
      if (!spec.program.modules)
        faults.add(position, "nothing dials in", "program: { modules: { listen: ADDRESS:PORT } }");
    }
    const Node* devices = value_of(bus, "devices");
    if (devices == nullptr) continue;
    for (std::size_t d = 0; d < std::min(devices->items.size(), spec.buses[i].devices.size());
         ++d) {
      const Node* number = value_of(*devices->items[d], "number");
      if (number == nullptr || spec.buses[i].devices[d].number.empty()) continue;
      numbers.add("device number", spec.buses[i].devices[d].number, number->position, faults);
      if (!spec.program.engineers)
        faults.add(number->position, "nobody can ask for it",
                   "program: { engineers: { listen: ADDRESS:PORT } }");
    }
  }
}

}  // namespace fieldcast::config
