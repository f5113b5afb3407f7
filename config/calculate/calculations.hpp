// The calculated channels of a whole configuration. Needs all its buses, because an input may
// belong to another bus.
#pragma once

#include <cstddef>
#include <span>

#include "config/document/document.hpp"
#include "core/model/spec.hpp"

namespace fieldcast::config {

// Limits of a bridge.
inline constexpr std::size_t kMaxCalculated = 10'000;
inline constexpr std::size_t kMaxCalculationDepth = 16;  // calculated from calculated channels

// Completes each calculated channel: its inputs, its formula and its refresh. Adds faults for names
// without a channel, cycles and everything that an expression must not contain. `places`: the value
// of `calculate` of each calculated channel, in the order of the channels; null after a fault.
void complete_calculations(BridgeSpec& spec, std::span<const Node* const> places,
                           FaultList& faults);

}  // namespace fieldcast::config
