// Rows of the tiers, and notes of rows still to write. Throws StoreError. One owner and thread.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "bridge/store/sql/sql.hpp"
#include "bridge/store/tiers/bucket.hpp"
#include "bridge/store/tiers/sample_table.hpp"

namespace fieldcast {

struct BucketKey {
  std::int64_t channel = 0;
  UtcTime start;
  friend bool operator==(const BucketKey&, const BucketKey&) = default;
};

class TierTable {
 public:
  explicit TierTable(SqlConnection& connection) : connection_(connection) {}

  // Replaces a row only by one with more samples: one with fewer was made after a removal.
  void put(const Tier& tier, std::span<const Bucket> buckets);
  // The rows of a channel with from <= start < to, in order, until the function returns false.
  void read(const Tier& tier, std::int64_t channel, UtcTime from, UtcTime to,
            const std::function<bool(const Bucket&)>& on_bucket);
  // Start of the first and the last row with from <= start < to; `std::nullopt` if none.
  [[nodiscard]] std::optional<UtcTime> first(const Tier& tier, std::int64_t channel, UtcTime from,
                                             UtcTime to);
  [[nodiscard]] std::optional<UtcTime> last(const Tier& tier, std::int64_t channel, UtcTime from,
                                            UtcTime to);
  // Removes the oldest rows before `before`, about `limit` at most. Returns their number.
  std::uint64_t remove_before(const Tier& tier, std::int64_t channel, UtcTime before,
                              std::uint64_t limit);

  // Notes of buckets with new samples, written with the samples, removed with writing the row.
  void note(const Tier& tier, std::span<const BucketKey> buckets);
  void forget(const Tier& tier, std::span<const BucketKey> buckets);
  // Returns those that begin before `before`, the oldest first.
  [[nodiscard]] std::vector<BucketKey> noted(const Tier& tier, UtcTime before, std::int64_t limit);
  [[nodiscard]] std::optional<UtcTime> oldest_noted(const Tier& tier);

  // Channels with samples of an older Fieldcast; those from `start` on have no tiers yet.
  [[nodiscard]] std::optional<BucketKey> next_untiered();
  void set_untiered(const BucketKey& next);
  void remove_untiered(std::int64_t channel);
  [[nodiscard]] bool is_untiered(std::int64_t channel);
  // The earliest start of all of them.
  [[nodiscard]] std::optional<UtcTime> oldest_untiered();

 private:
  [[nodiscard]] std::optional<UtcTime> time(const std::string& sql, const SqlRow& parameters);

  SqlConnection& connection_;
};

// History of channels in equal time intervals, from the coarsest suitable tier; parts that it lacks
// come from finer tiers and the samples. Throws StoreError. One owner and thread.
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
