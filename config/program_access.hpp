// Of `program`: who may dial in, and who may program. What engineers and modules have in common
// (TLS), and what only modules have (networks, secrets, certificates of modules).
#pragma once

#include "config/library.hpp"
#include "config/map_reader.hpp"
#include "core/model/spec.hpp"

namespace fieldcast::config {

// `certificate`, `key`, `authority`, `revoked`: PEM files.
[[nodiscard]] TlsSpec read_tls(MapReader& map, Library& library);

// How engineers log in, and where they must. `users`: there is a store, which keeps them.
// REQUIRES: TLS is read.
void check_engineers(MapReader& map, EngineersSpec& engineers, bool users);

// `subjects`, `secrets`, `from`, `security`. REQUIRES: the rows of the map are read.
void read_module_access(MapReader& map, ModulesSpec& modules, Library& library);

}  // namespace fieldcast::config
