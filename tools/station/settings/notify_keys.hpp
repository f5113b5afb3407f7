// The section `notify` of a station.
#pragma once

#include <optional>

#include "config/document/map_reader.hpp"
#include "config/files/library.hpp"
#include "tools/station/notify/notify_spec.hpp"

namespace fieldcast::web {

// Adds faults; with faults the result is incomplete.
void read_notify(config::MapReader& file, config::Library& library,
                 std::optional<NotifySpec>& spec);

}  // namespace fieldcast::web
