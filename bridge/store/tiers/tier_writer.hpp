// Writes the tiers of a store. With each batch, notes the buckets of its samples; when one is
// closed, reads its samples again and writes its row. So late samples, restarts and a second bridge
// need no special rule. Works in short transactions between batches; old samples are processed the
// same way. One owner, on the writer's thread. Throws StoreError; then call reset().
#pragma once

#include <span>
#include <vector>

#include "bridge/store/tiers/bucket.hpp"
#include "bridge/store/tiers/sample_table.hpp"
#include "bridge/store/tiers/tier_table.hpp"

namespace fieldcast {

class TierWriter {
 public:
  // Limits of one step. The last bucket is read completely, beyond the limit of samples.
  static constexpr std::int64_t kSamplesAtOnce = 20'000;
  static constexpr std::int64_t kBucketsAtOnce = 500;

  TierWriter();

  // Call in the transaction that stores these samples; `channel` is the store's number.
  void note(SqlConnection& connection, std::span<const SampleRow> samples);
  // Does one step if there is work. Returns false if every closed bucket is written.
  [[nodiscard]] bool step(SqlConnection& connection, UtcTime now);
  // Call after the connection was lost or a transaction was rolled back.
  void reset();

 private:
  [[nodiscard]] bool close_buckets(SqlConnection& connection, std::size_t tier, UtcTime before);
  [[nodiscard]] bool tier_old_samples(SqlConnection& connection, UtcTime before);
  // Includes the notes for the next tier.
  void put(SqlConnection& connection, std::size_t tier, std::span<const Bucket> buckets);

  std::vector<OpenBuckets> open_;
  std::int64_t at_once_ = kBucketsAtOnce;  // about as many as contain kSamplesAtOnce
  UtcTime done_before_;                    // all minutes that begin before are written
  bool old_samples_ = true;                // some samples may have no tiers
};

}  // namespace fieldcast
