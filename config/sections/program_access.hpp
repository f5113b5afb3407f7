#pragma once

#include "config/document/map_reader.hpp"
#include "config/files/library.hpp"
#include "core/model/program_spec.hpp"

namespace fieldcast::config {

// `certificate`, `key`, `authority`, `revoked`: PEM files.
[[nodiscard]] TlsSpec read_tls(MapReader& map, Library& library);

// `users`: a store with users exists. REQUIRES: TLS was read.
void check_engineers(MapReader& map, EngineersSpec& engineers, bool users);

// `subjects`, `secrets`, `from`, `security`. REQUIRES: the rows of the map were read.
void read_module_access(MapReader& map, ModulesSpec& modules, Library& library);

}  // namespace fieldcast::config
