#include "config/loader/loader.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "config/calculate/calculations.hpp"
#include "config/declaration/declaration.hpp"
#include "config/document/limits.hpp"
#include "config/document/scalars.hpp"
#include "config/files/file_reader.hpp"
#include "config/sections/bridge_keys.hpp"
#include "config/sections/bus.hpp"
#include "config/sections/dds.hpp"
#include "config/sections/port.hpp"
#include "config/sections/program.hpp"
#include "config/sections/store.hpp"
#include "core/schedule/overload.hpp"

namespace fieldcast::config {
namespace {

// REQUIRES: the programming server was read.
void read_metrics(MapReader& bridge, BridgeSpec& spec) {
  const Node* node = bridge.find("metrics");
  if (node == nullptr) return;
  MapReader map(*node, metrics_rows(), bridge.faults());
  MetricsSpec& metrics = spec.metrics.emplace();
  metrics_rows().read(map, metrics);
  const ProgramSpec& program = spec.program;
  const bool engineers = engineers_listen_at(program, metrics.listen);
  const bool modules = program.modules && program.modules->listen == metrics.listen;
  if (metrics.listen.port == 0 || (!engineers && !modules)) return;
  map.fault(
      "listen",
      fmt::format("metrics and {} listen at the same port", engineers ? "engineers" : "modules"),
      "a port of its own for each");
}

void read_identity(MapReader& bridge, BridgeSpec& spec) {
  const Node* node = bridge.require("bridge", "a name for the bridge");
  if (node == nullptr) return;
  if (node->kind != Kind::kMap) {
    if (auto name = NameRule{}(*node, "bridge", bridge.faults())) spec.name = std::move(*name);
    return;
  }
  MapReader map(*node, identity_rows(), bridge.faults());
  identity_rows().read(map, spec);
  if (map.find("standby") != nullptr)
    standby_rows().read_section(map, "standby", spec.standby.emplace());
}

void read_buses(MapReader& bridge, BridgeSpec& spec, LoadState& state) {
  auto& faults = state.faults;
  const Node* list = bridge.require("buses", "a list of buses");
  if (list == nullptr) return;
  if (!is_list(*list, "buses", 1, kAnyCount, "a list of buses", faults)) return;
  UniqueNames names, paths;
  std::size_t devices = 0;
  for (const Node* node : list->items) {
    if (spec.buses.size() == kMaxBuses) {
      faults.add(node->position, "too many buses", fmt::format("{} of a bridge", kMaxBuses));
      return;
    }
    const auto& bus = spec.buses.emplace_back(read_bus(*node, state));
    names.add("bus", bus.name, node->position, faults);
    devices += bus.devices.size();
    if (devices > kMaxBridgeDevices) {
      faults.add(node->position, "too many devices",
                 fmt::format("{} of a bridge", kMaxBridgeDevices));
      return;
    }
    if (const auto* serial = std::get_if<SerialPortSpec>(&bus.port)) {
      for (const auto& [key, value] : node->entries) {
        if (key->text == "port") paths.add("serial port", serial->path, value->position, faults);
      }
    }
  }
}

// Every server needs a port of its own. The gateways come last in `spec`.
void check_gateway_ports(const Node& buses, const BridgeSpec& spec, FaultList& faults) {
  std::vector<ListenSpec> taken;
  if (spec.metrics) taken.push_back(spec.metrics->listen);
  if (const auto& engineers = spec.program.engineers) {
    taken.push_back(engineers->listen);
    for (const EngineerPortSpec& port : engineers->ports) taken.push_back(port.listen);
  }
  if (spec.program.modules) taken.push_back(spec.program.modules->listen);
  for (std::size_t i = 0; i < std::min(buses.items.size(), spec.buses.size()); ++i) {
    const auto& gateway = spec.buses[i].gateway;
    if (!gateway || gateway->listen.port == 0) continue;
    if (std::ranges::find(taken, gateway->listen) != taken.end())
      faults.add(buses.items[i]->position,
                 fmt::format("the gateway of bus '{}' listens at the port of another server",
                             spec.buses[i].name),
                 "a port of its own for each");
    taken.push_back(gateway->listen);
  }
}

void read_bridge(const Node& root, BridgeSpec& spec, LoadState& state) {
  MapReader map(root, bridge_rows(), state.faults);
  read_identity(map, spec);
  read_dds(map, spec.dds, state.library);
  read_log(map, spec.log);
  read_program(map, spec.program, state.library);
  read_store(map, spec.store);
  read_metrics(map, spec);
  configure_rows().read_section(map, "configure", spec.configure);
  read_buses(map, spec, state);
  complete_calculations(spec, state.calculations, state.faults);
  check_device_numbers(root, spec, state.faults);
  if (const Node* buses = map.find("buses")) check_gateway_ports(*buses, spec, state.faults);
}

// REQUIRES: no faults so far.
void check_loads(const Node& root, const BridgeSpec& spec, FaultList& faults) {
  const auto buses = std::ranges::find(root.entries, "buses",
                                       [](const Node::Entry& entry) { return entry.key->text; });
  for (std::size_t i = 0; i < spec.buses.size(); ++i) {
    const auto load = hopeless_load_of(spec.buses[i]);
    if (!load) continue;
    faults.add(
        buses->value->items[i]->position,
        fmt::format("bus '{}' needs {} times its wire, even if devices respond immediately",
                    spec.buses[i].name, static_cast<std::uint64_t>(*load)),
        fmt::format("at most {} times, and 1 to keep every refresh: longer refreshes, fewer "
                    "channels, a faster line or more buses ('fieldcast plan' shows what is enough)",
                    static_cast<int>(kHopelessLoad)));
  }
}

std::vector<Fault> whole_file(const std::string& file, std::string what, std::string allowed = {}) {
  return {Fault{file, 1, 1, std::move(what), std::move(allowed), {}}};
}

std::vector<Fault> unread_file(const std::string& file, FileError error) {
  const bool large = error == FileError::kTooLarge;
  return whole_file(file, fmt::format("the file {}", to_text(error)),
                    large ? fmt::format("{} MiB", kMaxFileBytes >> 20) : "");
}

}  // namespace

Loaded load_text(std::string_view text, const std::string& file_name, const FileReader& reader,
                 const LoadOptions& options) {
  if (text.size() > kMaxFileBytes) {
    return tl::unexpected(
        whole_file(file_name, "the file is too large", fmt::format("{} MiB", kMaxFileBytes >> 20)));
  }
  if (!is_empty(text) && !is_configuration(text)) {
    return tl::unexpected(whole_file(file_name, std::string(kNoConfiguration),
                                     "a map with " + joined(bridge_rows().keys)));
  }
  FaultList faults;
  const std::shared_ptr<const Document> document =
      parse_yaml(Source{file_name, std::string(text), 0}, faults);
  BridgeSpec spec;
  if (document->root != nullptr) {
    Library library(reader, options, faults, text.size());
    LoadState state{faults, library};
    read_bridge(*document->root, spec, state);
    if (faults.empty() && options.refuse_hopeless) check_loads(*document->root, spec, faults);
  } else if (faults.empty()) {
    return tl::unexpected(
        whole_file(file_name, "the file is empty", "a map with " + joined(bridge_rows().keys)));
  }
  if (!faults.empty()) return tl::unexpected(faults.take());
  if (options.places != nullptr) *options.places = Places(document);
  return spec;
}

Loaded load_file(const std::string& path, const LoadOptions& options) {
  const auto reader = disk_reader();
  const auto text = reader.read(path);
  if (!text) return tl::unexpected(unread_file(path, text.error()));
  return load_text(*text, path, reader, options);
}

LoadedDeclaration load_declaration_text(std::string_view text, const std::string& file_name) {
  if (!is_empty(text) && !is_declaration(text)) {
    return tl::unexpected(whole_file(file_name, std::string(kNoDeclaration),
                                     "a map with summary, areas, operations"));
  }
  FaultList faults;
  const auto document = parse_yaml(Source{file_name, std::string(text), 0}, faults);
  declared::SharedDeclaration declaration;
  if (document->root != nullptr) {
    std::string_view name = std::string_view(file_name).substr(directory_of(file_name).size());
    if (name.ends_with(".yaml")) name.remove_suffix(5);
    declaration = read_declaration(*document->root, std::string(name), faults);
  } else if (faults.empty()) {
    return tl::unexpected(
        whole_file(file_name, "the file is empty", "a map with summary, areas, operations"));
  }
  if (!faults.empty()) return tl::unexpected(faults.take());
  return declaration;
}

LoadedDeclaration load_declaration(const std::string& path_or_name, const LoadOptions& options) {
  const auto reader = disk_reader();
  auto text = reader.read(path_or_name);
  std::string path = path_or_name;
  for (const auto& directory : options.protocol_directories) {
    if (text || path_or_name.find('/') != std::string::npos) break;
    path = fmt::format("{}/{}.yaml", directory, path_or_name);
    text = reader.read(path);
  }
  if (!text) return tl::unexpected(unread_file(path_or_name, text.error()));
  return load_declaration_text(*text, path);
}

}  // namespace fieldcast::config
