#include "core/base/time.hpp"

namespace fieldcast {

UtcTime UtcMapping::to_utc(Instant at) const {
  if (at == kLongAgo || at == kNever) return {};
  std::int64_t distance = 0, nanoseconds = 0;
  if (__builtin_sub_overflow(at.time_since_epoch().count(), instant.time_since_epoch().count(),
                             &distance) ||
      __builtin_add_overflow(utc.nanoseconds, distance, &nanoseconds)) {
    return at < instant ? UtcTime{INT64_MIN} : UtcTime{INT64_MAX};
  }
  return {nanoseconds};
}

Instant UtcMapping::to_instant(UtcTime at) const {
  std::int64_t distance = 0, nanoseconds = 0;
  if (__builtin_sub_overflow(at.nanoseconds, utc.nanoseconds, &distance) ||
      __builtin_add_overflow(instant.time_since_epoch().count(), distance, &nanoseconds)) {
    return at < utc ? kLongAgo : kNever;
  }
  return Instant{Duration{nanoseconds}};
}

UtcMapping UtcMapping::followed_by(const UtcMapping& newer) const {
  const std::int64_t now = newer.utc.nanoseconds, then = to_utc(newer.instant).nanoseconds;
  std::int64_t apart = 0;
  const bool far = __builtin_sub_overflow(now, then, &apart);
  return far || apart > kSame.count() || apart < -kSame.count() ? newer : *this;
}

}  // namespace fieldcast
