// Estimates the data rate that the samples of a configuration need for one station that watches all
// channels. Used for the warning that `max-rate` is too small. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/model/spec.hpp"

namespace fieldcast {

// Bytes per second of SampleBlock if every channel keeps its refresh. This is a lower bound,
// because blocks are counted as full.
[[nodiscard]] std::uint64_t sample_load(const BridgeSpec& spec);

// A one-line warning with the remedy; `std::nullopt` if `max-rate` is enough for one station or not
// set.
[[nodiscard]] std::optional<std::string> rate_remark(const BridgeSpec& spec);

}  // namespace fieldcast
