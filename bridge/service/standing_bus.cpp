#include "bridge/service/standing_bus.hpp"

#include <algorithm>

namespace fieldcast {

std::optional<StandingBus> standing_bus(const std::vector<BusTurn>& turns, Instant now,
                                        Duration limit) {
  const auto oldest = std::min_element(
      turns.begin(), turns.end(), [](const BusTurn& a, const BusTurn& b) { return a.at < b.at; });
  if (oldest == turns.end() || now - oldest->at <= limit) return std::nullopt;
  return StandingBus{oldest->bus, now - oldest->at};
}

}  // namespace fieldcast
