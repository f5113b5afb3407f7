// Estimates the data rate of all samples for one station, for the warning about `max-rate`. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/model/spec.hpp"

namespace fieldcast {

// Bytes per second of SampleBlock at every refresh; a lower bound, as blocks are counted as full.
[[nodiscard]] std::uint64_t sample_load(const BridgeSpec& spec);

// A one-line warning with the remedy; empty if `max-rate` is enough for one station or not set.
[[nodiscard]] std::optional<std::string> rate_remark(const BridgeSpec& spec);

}  // namespace fieldcast
