// History of channels in equal time intervals, from the coarsest suitable tier. Parts that this
// tier does not contain, such as the minutes of the present hour, come from finer tiers and finally
// from the samples. Everything throws StoreError. One owner, the thread of the connection.
#pragma once

#include <functional>
#include <optional>

#include "bridge/store/tiers/sample_table.hpp"
#include "bridge/store/tiers/tier_table.hpp"

namespace fieldcast {

class TierHistory {
 public:
  // `every`: the width of a bucket. REQUIRES: every > 0.
  TierHistory(SqlConnection& connection, Duration every)
      : samples_(connection), tiers_(connection), every_(every) {}

  // Reads the non-empty buckets of a channel in order, complete also at `from` and before `to`.
  // Stops if on_bucket returns false, and returns that.
  using OnBucket = std::function<bool(const Bucket& bucket)>;
  bool read(const StoredChannel& channel, UtcTime from, UtcTime to, const OnBucket& on_bucket);

  // A coarser tier has older data than read() can find.
  struct Reach {
    UtcTime oldest;            // start of the data that read() finds
    std::size_t coarser_tier;  // index in kTiers
    UtcTime coarser_oldest;
  };
  [[nodiscard]] std::optional<Reach> reach(const StoredChannel& channel);

 private:
  // Reads the rows of tier number `levels` - 1, and around them those of finer tiers; 0: samples.
  void read_levels(std::size_t levels, std::int64_t channel, UtcTime from, UtcTime to);
  void read_tier(std::size_t levels, std::int64_t channel, UtcTime from, UtcTime to);
  void read_samples(std::int64_t channel, UtcTime from, UtcTime to);
  // Returns the bucket of that time, after finishing and passing on the previous one.
  Bucket& bucket_at(UtcTime at);
  void finish();

  SampleTable samples_;
  TierTable tiers_;
  const Duration every_;
  // Used during read().
  Bucket bucket_;
  const OnBucket* on_bucket_ = nullptr;
  bool wanted_ = true;
};

}  // namespace fieldcast
