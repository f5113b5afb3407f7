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

}  // namespace fieldcast
