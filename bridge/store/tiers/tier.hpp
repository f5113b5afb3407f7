// Tiers of the store: samples, then one row per bucket in each tier, from the finest to the
// coarsest. Each tier is made from the one before it, the first from the samples. Pure: any thread,
// cannot fail.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "bridge/store/tiers/bucket.hpp"
#include "core/model/store_spec.hpp"

namespace fieldcast {

struct Tier {
  std::string_view name;
  std::string_view every;
  Duration width;
  Duration StoreSpec::*keep;  // how long its buckets are kept; 0: forever

  // The column `width` of the table `tiers`.
  [[nodiscard]] constexpr std::int64_t seconds() const {
    return std::chrono::duration_cast<std::chrono::seconds>(width).count();
  }
};

inline constexpr std::array<Tier, 2> kTiers{{
    {"minute", "1min", std::chrono::minutes{1}, &StoreSpec::keep_minutes},
    {"hour", "1h", std::chrono::hours{1}, &StoreSpec::keep_hours},
}};

// Delay between the end of a bucket and its closing; samples that wait in queues are then not late.
inline constexpr Duration kTierGrace = std::chrono::seconds{5};

// Buckets of this width that begin before the returned time are closed at `now`.
[[nodiscard]] UtcTime closed_before(UtcTime now, Duration width);

// The coarsest tier whose buckets combine to buckets of `every`; `std::nullopt`: only samples.
[[nodiscard]] std::optional<std::size_t> tier_for(Duration every);

// Returns the shortest round width that divides a span into at most `points` buckets: whole hours,
// minutes, seconds, or milliseconds. REQUIRES: span > 0, points > 0.
[[nodiscard]] Duration width_for(Duration span, std::uint32_t points);

}  // namespace fieldcast
