// What channels were in equal stretches of time, from the coarsest tier that serves. What that tier
// does not hold, such as the minutes of the present hour, comes from the finer ones and in the end
// from the samples. Everything throws StoreError. One owner, the thread of the connection.
#pragma once

#include <functional>
#include <optional>

#include "bridge/store/sample_table.hpp"
#include "bridge/store/tiers/tier_table.hpp"

namespace fieldcast {

class TierHistory {
 public:
  // `every`: the width of a bucket. REQUIRES: every > 0.
  TierHistory(SqlConnection& connection, Duration every)
      : samples_(connection), tiers_(connection), every_(every) {}

  // The buckets of a channel that hold something, in the order of time: whole ones, also those that
  // hold `from` and the instant before `to`. False from on_bucket ends it, and is returned.
  using OnBucket = std::function<bool(const Bucket& bucket)>;
  bool read(const StoredChannel& channel, UtcTime from, UtcTime to, const OnBucket& on_bucket);

  // A coarser tier knows of a time before everything that read() can find.
  struct Reach {
    UtcTime oldest;            // what read() finds begins here
    std::size_t coarser_tier;  // the index in kTiers
    UtcTime coarser_oldest;
  };
  [[nodiscard]] std::optional<Reach> reach(const StoredChannel& channel);

 private:
  // The rows of tier number `levels` - 1 and, around them, those of the finer ones; 0: samples.
  void read_levels(std::size_t levels, std::int64_t channel, UtcTime from, UtcTime to);
  void read_tier(std::size_t levels, std::int64_t channel, UtcTime from, UtcTime to);
  void read_samples(std::int64_t channel, UtcTime from, UtcTime to);
  // The bucket of that time: the one before it is finished and told.
  Bucket& bucket_at(UtcTime at);
  void finish();

  SampleTable samples_;
  TierTable tiers_;
  const Duration every_;
  // While reading.
  Bucket bucket_;
  const OnBucket* on_bucket_ = nullptr;
  bool wanted_ = true;
};

}  // namespace fieldcast
