// Writes the tiers of a store. With each batch it notes which buckets the samples touch; when such
// a bucket is closed, it reads the samples again and writes its row. So a sample that comes late, a
// restart and a second bridge need no rule of their own: the row is made anew from what is stored.
//
// The work is done in steps between batches, each a short transaction, so that no batch waits for
// it. A store of a Fieldcast without tiers gets those of its old samples in the same way. One
// owner, on the writer's thread. Everything throws StoreError; call reset() then.
#pragma once

#include <span>
#include <vector>

#include "bridge/store/sample_table.hpp"
#include "bridge/store/tiers/open_buckets.hpp"
#include "bridge/store/tiers/tier_table.hpp"

namespace fieldcast {

class TierWriter {
 public:
  // Limits of one step. A bucket is read whole: the last one may go beyond the samples.
  static constexpr std::int64_t kSamplesAtOnce = 20'000;
  static constexpr std::int64_t kBucketsAtOnce = 500;

  TierWriter();

  // In the transaction that stores these samples; `channel` is the store's number.
  void note(SqlConnection& connection, std::span<const SampleRow> samples);
  // Does a step, if there is something to do. False: nothing is closed that is not written.
  [[nodiscard]] bool step(SqlConnection& connection, UtcTime now);
  // The connection is gone, or a transaction was rolled back.
  void reset();

 private:
  [[nodiscard]] bool close_buckets(SqlConnection& connection, std::size_t tier, UtcTime before);
  [[nodiscard]] bool tier_old_samples(SqlConnection& connection, UtcTime before);
  // With the notes for the next tier.
  void put(SqlConnection& connection, std::size_t tier, std::span<const Bucket> buckets);

  std::vector<OpenBuckets> open_;          // one for each tier
  std::int64_t at_once_ = kBucketsAtOnce;  // about as many as have kSamplesAtOnce
  UtcTime done_before_;                    // minutes that begin before: all are written
  bool old_samples_ = true;                // perhaps: some have no tiers
};

}  // namespace fieldcast
