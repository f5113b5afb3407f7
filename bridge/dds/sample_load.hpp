// What the samples of a configuration need on the way to one station that watches everything, for
// the warning that a bound on the rate is too small for them. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/model/spec.hpp"

namespace fieldcast {

// Bytes a second of SampleBlock, when every channel keeps its refresh: at least, since blocks are
// counted as full as they can be.
[[nodiscard]] std::uint64_t sample_load(const BridgeSpec& spec);

// One line with the remedy; nothing: `max-rate` is enough for one station, or there is none.
[[nodiscard]] std::optional<std::string> rate_remark(const BridgeSpec& spec);

}  // namespace fieldcast
