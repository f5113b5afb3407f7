// The tiers of the store: samples as they are, then one row for each tier of buckets, from the
// finest to the coarsest. Each tier is made from the one before it, the first from the samples.
// Pure: any thread, nothing can fail.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "bridge/store/tiers/bucket.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

struct Tier {
  std::string_view name;   // for people: "minute"
  std::string_view every;  // as people write its width: "1min"
  Duration width;
  Duration StoreSpec::*keep;  // how long its buckets are kept; 0: for ever

  // The column `width` of the table `tiers`.
  [[nodiscard]] constexpr std::int64_t seconds() const {
    return std::chrono::duration_cast<std::chrono::seconds>(width).count();
  }
};

inline constexpr std::array<Tier, 2> kTiers{{
    {"minute", "1min", std::chrono::minutes{1}, &StoreSpec::keep_minutes},
    {"hour", "1h", std::chrono::hours{1}, &StoreSpec::keep_hours},
}};

// How long after its end a bucket is closed: what waits in queues until then is not late.
inline constexpr Duration kTierGrace = std::chrono::seconds{5};

// Buckets of that width that begin before this are closed at `now`.
[[nodiscard]] UtcTime closed_before(UtcTime now, Duration width);

// The index of the coarsest tier whose buckets add up to buckets of `every`; nothing: samples.
[[nodiscard]] std::optional<std::size_t> tier_for(Duration every);

// The shortest round duration that cuts a span into at most `points` buckets: whole hours, whole
// minutes, whole seconds, else whole milliseconds. REQUIRES: span > 0, points > 0.
[[nodiscard]] Duration width_for(Duration span, std::uint32_t points);

}  // namespace fieldcast
