// Whether the service manager's watchdog is fed: only while the thread of every bus turns. Pure.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/time.hpp"

namespace fieldcast {

// When the thread of a bus last came round; it does so at least once a second.
struct BusTurn {
  std::string bus;
  Instant at{};
};

struct StandingBus {
  std::string bus;
  Duration standing{};  // since its last turn
};

// The bus that has stood for longest, of those that have not turned for more than `limit`. None:
// all turn, the watchdog is fed.
[[nodiscard]] std::optional<StandingBus> standing_bus(const std::vector<BusTurn>& turns,
                                                      Instant now, Duration limit);

}  // namespace fieldcast
