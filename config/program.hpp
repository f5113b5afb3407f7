// `program`: where programming software and modules that dial in reach the bridge.
#pragma once

#include "config/library.hpp"
#include "config/map_reader.hpp"
#include "core/model/spec.hpp"

namespace fieldcast::config {

//     program:
//       engineers: { listen, certificate, key, authority, .., login, proof, heartbeat, idle }
//       modules: { listen, ask, prefix, unit, .., certificate, key, authority, .., from, second }
void read_program(MapReader& bridge, ProgramSpec& spec, Library& library);

// The device numbers of the whole file: each once, and only where somebody can ask for it or dial
// in. `buses` is the list of buses as written, beside the model that was made of it.
void check_device_numbers(const Node& buses, const BridgeSpec& spec, FaultList& faults);

// An address to listen at: a name would say too little about who can reach it.
struct ListenRule {
  int usual_port;  // of the example in its faults
  std::optional<ListenSpec> operator()(const Node& node, std::string_view key,
                                       FaultList& faults) const;
  [[nodiscard]] std::string schema() const;
  [[nodiscard]] std::string form() const;
};

// A device number, as core/program/device_number.hpp says.
struct DeviceNumberRule {
  std::optional<std::string> operator()(const Node& node, std::string_view key,
                                        FaultList& faults) const;
  [[nodiscard]] std::string schema() const;
  [[nodiscard]] std::string form() const;
};

}  // namespace fieldcast::config
