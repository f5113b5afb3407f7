#include "bridge/store/tiers/tier_writer.hpp"

#include <algorithm>

#include "core/base/time.hpp"
namespace fieldcast {
namespace {

// Fills the bucket from the previous tier or from samples. Returns the number of rows read.
std::int64_t read_bucket(SqlConnection& connection, std::size_t tier, Bucket& bucket) {
  std::int64_t rows = 0;
  const UtcTime end{saturated_sum(bucket.start.nanoseconds, kTiers[tier].width.count())};
  if (tier == 0) {
    SampleTable(connection)
        .numbers(bucket.channel, bucket.start, end, SampleTable::kNoLimit,
                 [&](UtcTime, Quality quality, const Value& value) {
                   bucket.add(quality, value);
                   ++rows;
                   return true;
                 });
    return rows;
  }
  TierTable(connection)
      .read(kTiers[tier - 1], bucket.channel, bucket.start, end, [&](const Bucket& part) {
        bucket.append(part);
        ++rows;
        return true;
      });
  return rows;
}

}  // namespace

TierWriter::TierWriter() {
  for (const Tier& tier : kTiers) open_.emplace_back(tier.width);
}

void TierWriter::reset() {
  for (OpenBuckets& open : open_) open.clear();
  done_before_ = {};
  old_samples_ = true;
}

void TierWriter::note(SqlConnection& connection, std::span<const SampleRow> samples) {
  std::vector<BucketKey> touched;
  for (const SampleRow& sample : samples) {
    if (sample.is_text) continue;
    const auto start = open_[0].touch(sample.channel, sample.published_at);
    if (!start) continue;
    touched.push_back({sample.channel, *start});
    if (*start < done_before_) done_before_ = {};  // late sample: check again
  }
  TierTable(connection).note(kTiers[0], touched);
}

bool TierWriter::step(SqlConnection& connection, UtcTime now) {
  const UtcTime minutes_before = closed_before(now, kTiers[0].width);
  if (done_before_ != minutes_before) {
    // A coarser tier is made after the finer one has nothing left to write.
    for (std::size_t tier = 0; tier < kTiers.size(); ++tier) {
      if (close_buckets(connection, tier, closed_before(now, kTiers[tier].width))) return true;
    }
    done_before_ = minutes_before;
  }
  return old_samples_ && tier_old_samples(connection, minutes_before);
}

bool TierWriter::close_buckets(SqlConnection& connection, std::size_t tier, UtcTime before) {
  TierTable table(connection);
  std::vector<BucketKey> keys = table.noted(kTiers[tier], before, at_once_);
  if (keys.empty()) return false;
  SqlTransaction transaction(connection);
  // First, so that the notes stay locked until the commit.
  table.forget(kTiers[tier], keys);
  std::vector<Bucket> buckets;
  std::int64_t rows = 0;
  std::size_t done = 0;
  for (; done < keys.size() && rows < kSamplesAtOnce; ++done) {
    Bucket bucket{.channel = keys[done].channel, .start = keys[done].start};
    rows += read_bucket(connection, tier, bucket);
    if (!bucket.empty()) buckets.push_back(bucket);
  }
  table.note(kTiers[tier], std::span(keys).subspan(done));
  put(connection, tier, buckets);
  transaction.commit();
  keys.resize(done);
  at_once_ =
      std::clamp(kSamplesAtOnce * static_cast<std::int64_t>(done) / std::max<std::int64_t>(rows, 1),
                 std::int64_t{1}, kBucketsAtOnce);
  for (const BucketKey& key : keys) open_[tier].close(key.channel, key.start);
  return true;
}

// Processes one part of one channel's samples. Returns false if no channel is left.
bool TierWriter::tier_old_samples(SqlConnection& connection, UtcTime before) {
  TierTable table(connection);
  const std::optional<BucketKey> from = table.next_untiered();
  if (!from) return old_samples_ = false;
  std::vector<Bucket> buckets;
  std::int64_t rows = 0;
  UtcTime last;
  SampleTable(connection)
      .numbers(from->channel, from->start, kEndOfTime, kSamplesAtOnce,
               [&](UtcTime at, Quality quality, const Value& value) {
                 const UtcTime start = bucket_start(at, kTiers[0].width);
                 if (rows++ == 0 || start != last) buckets.push_back({from->channel, last = start});
                 buckets.back().add(quality, value);
                 return true;
               });
  SqlTransaction transaction(connection);
  std::vector<BucketKey> open;
  if (rows < kSamplesAtOnce) {
    table.remove_untiered(from->channel);
  } else {
    // The rest of the last bucket has not been read. If one bucket fills the whole part, it is
    // noted and read completely later.
    const bool alone = buckets.size() == 1;
    if (alone) open.push_back({from->channel, last});
    buckets.pop_back();
    table.set_untiered(
        {from->channel,
         alone ? UtcTime{saturated_sum(last.nanoseconds, kTiers[0].width.count())} : last});
  }
  for (const Bucket& bucket : buckets) {
    if (bucket.start >= before) open.push_back({from->channel, bucket.start});
  }
  std::erase_if(buckets, [&](const Bucket& b) { return b.empty() || b.start >= before; });
  table.note(kTiers[0], open);
  if (!open.empty()) done_before_ = {};
  put(connection, 0, buckets);
  transaction.commit();
  return true;
}

void TierWriter::put(SqlConnection& connection, std::size_t tier, std::span<const Bucket> buckets) {
  TierTable table(connection);
  table.put(kTiers[tier], buckets);
  const std::size_t next = tier + 1;
  if (next == kTiers.size()) return;
  std::vector<BucketKey> touched;
  for (const Bucket& bucket : buckets) {
    if (const auto start = open_[next].touch(bucket.channel, bucket.start))
      touched.push_back({bucket.channel, *start});
  }
  table.note(kTiers[next], touched);
}

}  // namespace fieldcast
