// Decides whether the watchdog may be fed: only if the thread of every bus turns. Pure.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/time.hpp"

namespace fieldcast {

// Last turn of a bus's thread, which turns at least once a second.
struct BusTurn {
  std::string bus;
  Instant at{};
};

struct StandingBus {
  std::string bus;
  Duration standing{};
};

// Returns the bus with the oldest turn before `limit`, or `std::nullopt` if all turn.
[[nodiscard]] std::optional<StandingBus> standing_bus(const std::vector<BusTurn>& turns,
                                                      Instant now, Duration limit);

}  // namespace fieldcast
