#include "bridge/store/tiers/tier.hpp"

namespace fieldcast {
namespace {

// A span that begins inside a bucket touches one bucket more than fit into it.
Duration shortest_width(Duration span, std::uint32_t points, Duration unit) {
  const std::int64_t cuts = points > 1 ? points - 1 : 1;
  const std::int64_t whole = unit.count() * cuts;
  const std::int64_t units = span.count() / whole + (span.count() % whole != 0 ? 1 : 0);
  return unit * std::max<std::int64_t>(units, 1);
}

}  // namespace

UtcTime closed_before(UtcTime now, Duration width) {
  return bucket_start({now.nanoseconds - kTierGrace.count()}, width);
}

std::optional<std::size_t> tier_for(Duration every) {
  for (std::size_t tier = kTiers.size(); tier-- > 0;) {
    if (every >= kTiers[tier].width && every % kTiers[tier].width == Duration{}) return tier;
  }
  return std::nullopt;
}

Duration width_for(Duration span, std::uint32_t points) {
  using namespace std::chrono_literals;
  for (const Duration unit : {Duration{1h}, Duration{1min}, Duration{1s}}) {
    // A unit longer than needed would give far fewer points than requested.
    if (shortest_width(span, points, 1ms) >= unit) return shortest_width(span, points, unit);
  }
  return shortest_width(span, points, 1ms);
}

}  // namespace fieldcast
