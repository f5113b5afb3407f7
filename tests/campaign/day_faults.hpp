// What goes wrong in a day of a bus, and which configurations it has: chosen by chance, the same
// for the same seed. Pure functions.
#pragma once

#include <random>

#include "tests/bus/late_storm.hpp"
#include "tools/sim/bus/sim_bus.hpp"

namespace fieldcast::test {

// The last part of a day is calm.
inline constexpr Duration kCalm = std::chrono::minutes{20};

[[nodiscard]] sim::BusFaults bus_faults(const StormKind& kind, const BusSpec& spec,
                                        std::mt19937_64& random, Duration length);
// Some channels of each device, with refreshes, deadbands and interests of their own.
[[nodiscard]] BusSpec variant_of(const BusSpec& whole, std::mt19937_64& random);

}  // namespace fieldcast::test
