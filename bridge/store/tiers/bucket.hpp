// A bucket of a tier: summary of the samples of one channel in a time interval, such as a minute.
// Pure values and functions: no database, no clock; any thread. Cannot fail.
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/cause.hpp"
#include "core/base/time.hpp"
#include "core/base/value.hpp"

namespace fieldcast {

// Returns the start of the bucket of this width that contains `at`, by integer division of the
// nanoseconds since 1970: minutes and hours begin as in UTC. REQUIRES: width > 0.
[[nodiscard]] UtcTime bucket_start(UtcTime at, Duration width);

// Good: good samples with a finite number (a boolean is 0 or 1). Bad: all others except texts.
struct Bucket {
  std::int64_t channel = 0;  // the store's number
  UtcTime start;
  std::uint64_t count = 0;  // good samples
  std::uint64_t bad = 0;
  // Of the good samples; undefined if count is 0.
  double min = 0;
  double max = 0;
  double sum = 0;
  double first = 0;
  double last = 0;

  [[nodiscard]] bool empty() const { return count == 0 && bad == 0; }
  [[nodiscard]] std::optional<double> average() const {  // empty if no sample is good
    return count == 0 ? std::nullopt : std::optional(sum / static_cast<double>(count));
  }

  // Adds a sample of this bucket. REQUIRES: samples are added in the order of time.
  void add(Quality quality, const Value& value);
  // Appends the next bucket or part. Channel and start do not change.
  void append(const Bucket& later);

  friend bool operator==(const Bucket&, const Bucket&) = default;
};

}  // namespace fieldcast
