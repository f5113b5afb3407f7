// The section `notify` of a station.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "config/document/map_reader.hpp"
#include "config/files/library.hpp"
#include "tools/station/notify/notify_spec.hpp"

namespace fieldcast::web {

// Adds faults; with faults the result is incomplete.
void read_notify(config::MapReader& file, config::Library& library,
                 std::optional<NotifySpec>& spec);

// Each with the prefix of its keys in the document: "notify.rules.".
[[nodiscard]] std::vector<std::pair<std::string, const config::RowTable*>> notify_tables();

}  // namespace fieldcast::web
