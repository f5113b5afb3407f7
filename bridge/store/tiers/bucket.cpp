#include "bridge/store/tiers/bucket.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/time.hpp"

namespace fieldcast {

namespace {

std::optional<double> number_of(const Value& value) {
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? 1 : 0;
  return as_number(value);
}

}  // namespace

UtcTime bucket_start(UtcTime at, Duration width) {
  const std::int64_t past = at.nanoseconds % width.count();
  return {saturated_difference(at.nanoseconds, past < 0 ? past + width.count() : past)};
}

void Bucket::add(Quality quality, const Value& value) {
  if (std::holds_alternative<std::string>(value)) return;
  const std::optional<double> number = number_of(value);
  if (quality != Quality::kGood || !number || !std::isfinite(*number)) {
    ++bad;
    return;
  }
  append({.count = 1,
          .min = *number,
          .max = *number,
          .sum = *number,
          .first = *number,
          .last = *number});
}

void Bucket::append(const Bucket& later) {
  bad += later.bad;
  if (later.count == 0) return;
  min = count == 0 ? later.min : std::min(min, later.min);
  max = count == 0 ? later.max : std::max(max, later.max);
  if (count == 0) first = later.first;
  last = later.last;
  sum += later.sum;
  count += later.count;
}

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
