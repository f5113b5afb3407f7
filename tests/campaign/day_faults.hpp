// Random faults and configurations for a day of a bus, deterministic by seed. Pure functions.
#pragma once

#include <random>

#include "tests/bus/late_storm.hpp"
#include "tools/sim/bus/sim_bus.hpp"

namespace fieldcast::test {

// Time without faults at the end of a day.
inline constexpr Duration kCalm = std::chrono::minutes{20};

[[nodiscard]] sim::BusFaults bus_faults(const StormKind& kind, const BusSpec& spec,
                                        std::mt19937_64& random, Duration length);
// Selects some channels of each device, with random refreshes, deadbands and interests.
[[nodiscard]] BusSpec variant_of(const BusSpec& whole, std::mt19937_64& random);

}  // namespace fieldcast::test
