// A bucket of a tier: summary of one channel in a time interval, such as a minute. Pure values.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <unordered_map>

#include "core/base/cause.hpp"
#include "core/base/time.hpp"
#include "core/base/value.hpp"
#include "core/model/store_spec.hpp"

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

// Which buckets of one tier were noted as open: the store notes each once, not for every sample. A
// forgotten one is noted again. Pure; one owner, on the writer's thread.
class OpenBuckets {
 public:
  explicit OpenBuckets(Duration width) : width_(width) {}

  // A sample of the channel was published at `at`. Returns its bucket if it must be noted now.
  [[nodiscard]] std::optional<UtcTime> touch(std::int64_t channel, UtcTime at) {
    const UtcTime start = bucket_start(at, width_);
    const auto [known, added] = newest_.try_emplace(channel, start);
    if (!added && known->second == start) return std::nullopt;
    known->second = start;
    return start;
  }
  // The bucket was written; a late sample notes it again.
  void close(std::int64_t channel, UtcTime start) {
    const auto known = newest_.find(channel);
    if (known != newest_.end() && known->second == start) newest_.erase(known);
  }
  void clear() { newest_.clear(); }

 private:
  const Duration width_;
  // Last bucket by channel; one entry for each channel of the store.
  std::unordered_map<std::int64_t, UtcTime> newest_;
};

// Tiers of the store, from the finest to the coarsest: one row per bucket. Each is made from the
// one before it, the first from the samples. Pure: any thread, cannot fail.
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
