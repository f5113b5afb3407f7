// One bucket of a tier: what the samples of one channel were in one stretch of time, such as a
// minute. Pure values and functions: no database, no clock; any thread. Nothing can fail.
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/quality.hpp"
#include "core/base/time.hpp"
#include "core/base/value.hpp"

namespace fieldcast {

// The beginning of the bucket that holds `at`, for buckets of that width: the integer division of
// the nanoseconds since 1970, so that minutes and hours begin where UTC has them.
// REQUIRES: width > 0.
[[nodiscard]] UtcTime bucket_start(UtcTime at, Duration width);

// Only good samples with a finite number count. Every other one is bad, but a text, which is
// neither. A boolean is 0 or 1.
struct Bucket {
  std::int64_t channel = 0;  // the store's number
  UtcTime start;
  std::uint64_t count = 0;  // good samples
  std::uint64_t bad = 0;    // all others
  // Of the good samples; without meaning while count is 0.
  double min = 0;
  double max = 0;
  double sum = 0;
  double first = 0;
  double last = 0;

  [[nodiscard]] bool empty() const { return count == 0 && bad == 0; }
  [[nodiscard]] std::optional<double> average() const {  // nothing: no sample is good
    return count == 0 ? std::nullopt : std::optional(sum / static_cast<double>(count));
  }

  // A sample of this bucket. REQUIRES: samples come in the order of their time.
  void add(Quality quality, const Value& value);
  // The bucket that follows, or a part of it. Channel and start stay.
  void append(const Bucket& later);

  friend bool operator==(const Bucket&, const Bucket&) = default;
};

}  // namespace fieldcast
