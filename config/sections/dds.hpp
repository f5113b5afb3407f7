// The `dds` and `log` sections, and the `sites` of a program that uses several domains.
#pragma once

#include <cstdint>
#include <vector>

#include "config/document/map_reader.hpp"
#include "config/files/library.hpp"
#include "core/model/spec.hpp"

namespace fieldcast::config {

// Add faults; absent keys keep their defaults.
void read_dds(MapReader& file, DdsSpec& spec, Library& library);
void read_log(MapReader& file, LogSpec& spec);
// Without `sites`, returns one site without a name. REQUIRES: the table has both keys.
[[nodiscard]] std::vector<DdsSite> read_sites(MapReader& file, Library& library);

}  // namespace fieldcast::config
