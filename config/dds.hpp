// The `dds` and `log` sections, which every program of a plant has alike.
#pragma once

#include "config/library.hpp"
#include "config/map_reader.hpp"
#include "core/model/spec.hpp"

namespace fieldcast::config {

// Faults are noted; what is absent keeps its default.
void read_dds(MapReader& file, DdsSpec& spec, Library& library);
void read_log(MapReader& file, LogSpec& spec);

}  // namespace fieldcast::config
