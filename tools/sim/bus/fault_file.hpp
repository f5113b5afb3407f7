// Parses the faults file (tools/sim/README.md) and checks its names against the plant. Returns all
// faults with file, line and column.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "config/document/fault.hpp"
#include "core/model/spec.hpp"
#include "tools/sim/bus/wire.hpp"

namespace fieldcast::sim {

using LoadedFaults = tl::expected<Faults, std::vector<config::Fault>>;

[[nodiscard]] LoadedFaults parse_faults(std::string_view text, const std::string& file_name,
                                        const BridgeSpec& plant);
[[nodiscard]] LoadedFaults load_faults(const std::string& path, const BridgeSpec& plant);

}  // namespace fieldcast::sim
