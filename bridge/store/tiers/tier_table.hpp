// The rows of the tiers, and the notes of what is still to be written there. Everything throws
// StoreError. One owner, the thread of the connection.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "bridge/store/sql.hpp"
#include "bridge/store/tiers/tier.hpp"

namespace fieldcast {

// A bucket by its key.
struct BucketKey {
  std::int64_t channel = 0;
  UtcTime start;
  friend bool operator==(const BucketKey&, const BucketKey&) = default;
};

class TierTable {
 public:
  explicit TierTable(SqlConnection& connection) : connection_(connection) {}

  // Puts rows in. One that is there gives way to a row of more samples only: samples never change,
  // so a row of fewer was made after the retention had removed some.
  void put(const Tier& tier, std::span<const Bucket> buckets);
  // The rows of a channel of from <= start < to, in the order of time. False ends it.
  void read(const Tier& tier, std::int64_t channel, UtcTime from, UtcTime to,
            const std::function<bool(const Bucket&)>& on_bucket);
  // Where the first and the last row of a channel begin, of from <= start < to; nothing: no row.
  [[nodiscard]] std::optional<UtcTime> first(const Tier& tier, std::int64_t channel, UtcTime from,
                                             UtcTime to);
  [[nodiscard]] std::optional<UtcTime> last(const Tier& tier, std::int64_t channel, UtcTime from,
                                            UtcTime to);
  // Removes rows of a channel that begin before, the oldest first, about `limit` at most. How many
  // went.
  std::uint64_t remove_before(const Tier& tier, std::int64_t channel, UtcTime before,
                              std::uint64_t limit);

  // Notes of buckets that have new samples: made with the samples, gone with the row that is
  // written.
  void note(const Tier& tier, std::span<const BucketKey> buckets);
  void forget(const Tier& tier, std::span<const BucketKey> buckets);
  // Those that begin before, the oldest first.
  [[nodiscard]] std::vector<BucketKey> noted(const Tier& tier, UtcTime before, std::int64_t limit);
  // Where the oldest one that is noted begins; nothing: none is.
  [[nodiscard]] std::optional<UtcTime> oldest_noted(const Tier& tier);

  // Channels with samples that an older Fieldcast stored: those from start on have no tiers yet.
  [[nodiscard]] std::optional<BucketKey> next_untiered();
  void set_untiered(const BucketKey& next);
  void remove_untiered(std::int64_t channel);
  [[nodiscard]] bool is_untiered(std::int64_t channel);
  // The least start of all of them.
  [[nodiscard]] std::optional<UtcTime> oldest_untiered();

 private:
  [[nodiscard]] std::optional<UtcTime> time(const std::string& sql, const SqlRow& parameters);

  SqlConnection& connection_;
};

}  // namespace fieldcast
