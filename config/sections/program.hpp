#pragma once

#include "config/document/map_reader.hpp"
#include "config/files/library.hpp"
#include "core/model/program_spec.hpp"
#include "core/model/spec.hpp"

namespace fieldcast::config {

// program:
//       engineers: { listen, certificate, key, authority, .., login, proof, heartbeat, idle,
//         ports: [ { device, listen, mode, user, from, security } ] }
//       modules: { listen, ask, prefix, unit, .., certificate, key, authority, .., from, second }
void read_program(MapReader& bridge, ProgramSpec& spec, Library& library);

// Each number must be unique and usable by an engineer or a module, and an engineer's port must be
// for one of them. `bridge`: as written.
void check_device_numbers(const Node& bridge, const BridgeSpec& spec, FaultList& faults);

// Whether the server of engineers or one of their ports listens there.
[[nodiscard]] bool engineers_listen_at(const ProgramSpec& program, const ListenSpec& place);

// A host name is not allowed, as it would not show which clients can connect.
struct ListenRule {
  int usual_port;  // of the example in its faults
  std::optional<ListenSpec> operator()(const Node& node, std::string_view key,
                                       FaultList& faults) const;
  [[nodiscard]] std::string schema() const;
  [[nodiscard]] std::string form() const;
};

// See core/program/frame.hpp.
struct DeviceNumberRule {
  std::optional<std::string> operator()(const Node& node, std::string_view key,
                                        FaultList& faults) const;
  [[nodiscard]] std::string schema() const;
  [[nodiscard]] std::string form() const;
};

// A list of addresses and networks, for access::Network.
void read_networks(MapReader& map, std::string_view key, std::vector<std::string>& networks);

// `certificate`, `key`, `authority`, `revoked`: PEM files.
[[nodiscard]] TlsSpec read_tls(MapReader& map, Library& library);

// `users`: a store with users exists. REQUIRES: TLS was read.
void check_engineers(MapReader& map, EngineersSpec& engineers, bool users);

// REQUIRES: the rows and `from` of the port were read, and the ports before it.
void check_engineer_port(MapReader& map, const EngineersSpec& engineers,
                         const EngineerPortSpec& port, bool users);

// `subjects`, `secrets`, `from`, `security`. REQUIRES: the rows of the map were read.
void read_module_access(MapReader& map, ModulesSpec& modules, Library& library);

}  // namespace fieldcast::config
