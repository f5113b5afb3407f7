#include "tools/station/record/sample_stamp.hpp"

#include <algorithm>

#include "core/base/time.hpp"

namespace fieldcast::web {
namespace {

// The times are untrusted network data: any 64-bit number.
Duration between(UtcTime from, UtcTime to) {
  return Duration{saturated_difference(to.nanoseconds, from.nanoseconds)};
}
UtcTime operator-(UtcTime time, Duration by) {
  return {saturated_difference(time.nanoseconds, by.count())};
}

}  // namespace

void ClockOffset::note(UtcTime acquired, UtcTime received) {
  const Duration offset = between(acquired, received);
  if (offset > SampleStamp::kMaxOffset || offset < -SampleStamp::kMaxOffset) return;
  const Duration age = between(window_began_, received);
  if (age >= kWindow || age < Duration{}) {
    before_ = age < 2 * kWindow ? now_ : std::nullopt;
    now_.reset();
    window_began_ = received;
  }
  now_ = now_ ? std::min(*now_, offset) : offset;
}

Duration ClockOffset::least() const {
  if (before_ && now_) return std::min(*before_, *now_);
  return before_.value_or(now_.value_or(Duration{}));
}

std::optional<UtcTime> SampleStamp::next(const StationSample& sample, UtcTime received,
                                         Duration offset, bool first) {
  if (any_ && sample.sequence == sequence_ && sample.acquired_at == acquired_ &&
      sample.quality == quality_)
    return std::nullopt;
  const Duration age = between(sample.acquired_at, received);
  const bool by_acquisition = sample.quality == Quality::kGood && age >= -kMaxOffset &&
                              age <= (first ? kOldest : kMaxOffset);
  UtcTime published = by_acquisition ? sample.acquired_at : received - offset;
  if (any_ && published <= published_ && between(published, published_) < kOrder)
    published = UtcTime{saturated_sum(published_.nanoseconds, 1)};
  any_ = true;
  sequence_ = sample.sequence;
  acquired_ = sample.acquired_at;
  quality_ = sample.quality;
  return published_ = published;
}

}  // namespace fieldcast::web
