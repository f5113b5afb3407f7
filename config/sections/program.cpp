#include "config/sections/program.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "config/document/document.hpp"
#include "config/document/limits.hpp"
#include "config/document/scalars.hpp"
#include "config/sections/bridge_keys.hpp"
#include "config/sections/port.hpp"
#include "core/access/network.hpp"
#include "core/program/frame.hpp"

namespace fieldcast::config {

namespace {

using program::RegistrationRule;

// REQUIRES: the engineers are read.
void read_engineer_ports(MapReader& engineers, EngineersSpec& spec, bool users) {
  const Node* node = engineers.find("ports");
  if (node == nullptr) return;
  FaultList& faults = engineers.faults();
  if (!is_list(*node, "ports", 1, kMaxInterfaces, "a list of ports", faults)) return;
  for (const Node* item : node->items) {
    MapReader map(*item, engineer_port_rows(), faults);
    EngineerPortSpec port;
    engineer_port_rows().read(map, port);
    read_networks(map, "from", port.from);
    check_engineer_port(map, spec, port, users);
    spec.ports.push_back(std::move(port));
  }
}

// `users`: a store with users exists.
void read_engineers(MapReader& program, ProgramSpec& spec, Library& library, bool users) {
  const Node* node = program.find("engineers");
  if (node == nullptr) return;
  MapReader map(*node, engineer_rows(), program.faults());
  EngineersSpec& engineers = spec.engineers.emplace();
  engineer_rows().read(map, engineers);
  engineers.tls = read_tls(map, library);
  check_engineers(map, engineers, users);
  read_engineer_ports(map, engineers, users);
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
      map.fault(key, fmt::format("'{}' has no meaning for ask: text", key), "ask: words");
  }
}

const Node* value_of(const Node& map, std::string_view key) {
  for (const auto& [name, value] : map.entries) {
    if (name->text == key) return value;
  }
  return nullptr;
}

// A module without a bus may dial in with any number.
void check_devices_of_ports(const Node& bridge, const BridgeSpec& spec, FaultList& faults) {
  if (!spec.program.engineers || spec.program.modules) return;
  const auto has_number = [&](const std::string& number) {
    return std::ranges::any_of(spec.buses, [&](const BusSpec& bus) {
      return std::ranges::find(bus.devices, number, &DeviceSpec::number) != bus.devices.end();
    });
  };
  const Node* node = &bridge;
  for (const auto* key : {"program", "engineers", "ports"}) {
    if (node = value_of(*node, key); node == nullptr) return;
  }
  const auto& ports = spec.program.engineers->ports;
  for (std::size_t i = 0; i < std::min(node->items.size(), ports.size()); ++i) {
    const Node* device = value_of(*node->items[i], "device");
    if (device != nullptr && !ports[i].device.empty() && !has_number(ports[i].device))
      faults.add(device->position, fmt::format("no device has the number '{}'", ports[i].device),
                 "`number` of a device, or program: { modules: .. } for one that dials in");
  }
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
  if (spec.modules && engineers_listen_at(spec, spec.modules->listen) &&
      spec.modules->listen.port != 0) {
    map.fault("modules", "modules and engineers listen at the same port",
              "a port of its own for each");
  }
}

bool engineers_listen_at(const ProgramSpec& program, const ListenSpec& place) {
  if (!program.engineers) return false;
  const auto& ports = program.engineers->ports;
  return program.engineers->listen == place ||
         std::ranges::find(ports, place, &EngineerPortSpec::listen) != ports.end();
}

void check_device_numbers(const Node& bridge, const BridgeSpec& spec, FaultList& faults) {
  const Node* buses = value_of(bridge, "buses");
  if (buses == nullptr) return;
  UniqueNames numbers;
  for (std::size_t i = 0; i < std::min(buses->items.size(), spec.buses.size()); ++i) {
    const Node& bus = *buses->items[i];
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
  check_devices_of_ports(bridge, spec, faults);
}

namespace {

// `needed`: the key that `key` depends on.
void check_needed(MapReader& map, std::string_view key, std::string_view needed,
                  std::string_view allowed) {
  if (map.has(key) && !map.has(needed))
    map.fault(key, fmt::format("'{}' without '{}'", key, needed), allowed);
}

std::vector<std::string> numbers_of(const Node& node, std::string_view name, FaultList& faults) {
  std::vector<std::string> numbers;
  const auto take = [&](const Node& item) {
    if (auto number = DeviceNumberRule{}(item, name, faults)) numbers.push_back(*std::move(number));
  };
  if (node.kind != Kind::kList) {
    take(node);
    return numbers;
  }
  for (const Node* item : node.items) take(*item);
  return numbers;
}

void read_subjects(MapReader& map, ModulesSpec& modules) {
  const Node* node = map.find("subjects");
  if (node == nullptr) return;
  if (node->kind != Kind::kMap) {
    return map.fault("subjects", "subjects is " + std::string(to_text(node->kind)),
                     "common names of certificates and the numbers of their modules: { hut: 17, "
                     "gateway: [18, 19] }");
  }
  for (const Node::Entry& entry : node->entries)
    modules.subjects[entry.key->text] = numbers_of(*entry.value, entry.key->text, map.faults());
}

}  // namespace

void read_networks(MapReader& map, std::string_view key, std::vector<std::string>& networks) {
  static constexpr std::string_view kForm = "addresses and networks: [10.0.7.0/24, 192.168.1.7]";
  const Node* node = map.find(key);
  if (node == nullptr) return;
  if (!is_list(*node, key, 1, kMaxInterfaces, kForm, map.faults())) return;
  for (const Node* item : node->items) {
    const std::string* text = scalar_of(*item, key, kForm, map.faults());
    if (text == nullptr) continue;
    if (!access::Network::parse(*text))
      map.faults().add(item->position, fmt::format("'{}' is no address and no network", *text),
                       kForm);
    networks.push_back(*text);
  }
}

TlsSpec read_tls(MapReader& map, Library& library) {
  TlsSpec tls;
  for (const auto& [key, target] :
       {std::pair{"certificate", &tls.certificate}, std::pair{"key", &tls.key},
        std::pair{"authority", &tls.authority}, std::pair{"revoked", &tls.revoked}}) {
    std::string path;
    if (map.read(key, path, TextRule{kMaxPath})) *target = library.check_file(*map.find(key));
  }
  const bool certificate = map.has("certificate"), key = map.has("key");
  if (certificate != key) {
    map.fault(certificate ? "certificate" : "key",
              certificate ? "'certificate' without 'key'" : "'key' without 'certificate'",
              "both, as PEM files");
  }
  if (!certificate && !key)
    check_needed(map, "authority", "certificate", "certificate and key of the bridge, for TLS");
  check_needed(map, "revoked", "authority", "authority: who signs the certificates, a PEM file");
  return tls;
}

void check_engineers(MapReader& map, EngineersSpec& engineers, bool users) {
  const bool authority = map.has("authority");
  if (authority && !map.has("proof")) engineers.proof = LoginProof::kCertificate;
  const bool by_certificate = engineers.proof != LoginProof::kPassword;
  if (by_certificate && !authority)
    map.fault("proof", "certificates of engineers, and nobody signs them",
              "authority: a PEM file with who signs them");
  if (!by_certificate && authority)
    map.fault("authority", "'authority' has no meaning for proof: password",
              "proof: certificate, either or both");
  if (engineers.listen.host.empty()) return;
  const bool far = !on_loopback(engineers.listen);
  if (far && !map.has("certificate") && !map.has("key"))
    map.fault("listen", "engineers off the loopback without TLS",
              "certificate and key, or an address 127.0.0.1");
  // Without users, every holder of a certificate of the authority is an engineer.
  if (users || engineers.proof == LoginProof::kCertificate) return;
  static constexpr std::string_view kRemedy =
      "store: { path: FILE } and 'fieldcast user add NAME --role programmer'";
  if (far) {
    map.fault("listen",
              "engineers off the loopback have to log in, and without a store there are no users",
              fmt::format("{}, or an address 127.0.0.1", kRemedy));
  } else if (engineers.login == LoginRule::kAlways || by_certificate) {
    map.fault(engineers.login == LoginRule::kAlways ? "login" : "proof",
              "a login needs users, and without a store there are none", kRemedy);
  }
}

void check_engineer_port(MapReader& map, const EngineersSpec& engineers,
                         const EngineerPortSpec& port, bool users) {
  if (port.listen.host.empty()) return;
  const bool taken = port.listen == engineers.listen ||
                     std::ranges::any_of(engineers.ports, [&](const EngineerPortSpec& other) {
                       return other.listen == port.listen;
                     });
  if (taken && port.listen.port != 0)
    map.fault("listen", "two ports of engineers listen at the same address",
              "a port of its own for each");
  const bool far = !on_loopback(port.listen), tls = !engineers.tls.certificate.empty();
  if (far && !tls && !port.without_security)
    map.fault("listen", "a plain text port off the loopback",
              "certificate and key in 'engineers', an address 127.0.0.1, or security: none");
  if (tls && port.without_security)
    map.fault("security", "security: none beside the certificate of 'engineers'", "one of them");
  const bool needs_login = engineers.login == LoginRule::kAlways || (far && port.from.empty()) ||
                           engineers.proof == LoginProof::kBoth;
  if (engineers.proof == LoginProof::kCertificate || !needs_login) return;
  if (port.raw && engineers.proof != LoginProof::kEither)
    map.fault("mode", "a raw port has no prompt for a password",
              "mode: rfc2217, proof: certificate or either in 'engineers', or from");
  if (!users)
    map.fault("listen", "a login needs users, and without a store there are none",
              "store: { path: FILE } and 'fieldcast user add NAME --role programmer'");
}

void read_module_access(MapReader& map, ModulesSpec& modules, Library& library) {
  modules.tls = read_tls(map, library);
  check_needed(map, "subjects", "authority", "authority: who signs the certificates of modules");
  read_subjects(map, modules);
  read_networks(map, "from", modules.from);
  std::string path;
  if (map.read("secrets", path, TextRule{kMaxPath}))
    modules.secrets = library.check_file(*map.find("secrets"));
  if (map.has("secrets") && modules.registration.ask == program::RegistrationRule::Ask::kWords)
    map.fault("secrets", "a module that is asked for a text does not respond to a challenge",
              "ask: text");
  const bool held = map.has("authority") || map.has("secrets") || map.has("from");
  if (modules.without_security && held)
    map.fault("security", "security: none beside what modules have to show",
              "one of them: security: none, or authority, secrets or from");
  if (!held && !modules.without_security && !modules.listen.host.empty() &&
      !on_loopback(modules.listen)) {
    map.fault("listen", "modules off the loopback, and nothing is said about who may dial in",
              "authority with certificate and key, secrets, from, or security: none");
  }
}

}  // namespace fieldcast::config
