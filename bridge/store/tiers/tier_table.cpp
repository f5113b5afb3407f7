#include "bridge/store/tiers/tier_table.hpp"

#include <limits>

#include "core/base/time.hpp"

namespace fieldcast {

namespace {

// Null if no sample was good, or if a sum overflowed: SQLite cannot store NaN.
double number_at(const SqlRow& row, std::size_t column) {
  const auto* real = std::get_if<double>(&row.at(column));
  return real == nullptr ? std::numeric_limits<double>::quiet_NaN() : *real;
}

SqlRow row_of(const Tier& tier, const Bucket& bucket) {
  SqlRow row{tier.seconds(), bucket.channel, bucket.start.nanoseconds,
             static_cast<std::int64_t>(bucket.count), static_cast<std::int64_t>(bucket.bad)};
  for (const double number : {bucket.min, bucket.max, bucket.sum, bucket.first, bucket.last}) {
    if (bucket.count == 0)
      row.emplace_back();
    else
      row.emplace_back(number);
  }
  return row;
}

std::vector<SqlRow> rows_of(const Tier& tier, std::span<const BucketKey> buckets) {
  std::vector<SqlRow> rows;
  rows.reserve(buckets.size());
  for (const BucketKey& bucket : buckets)
    rows.push_back({tier.seconds(), bucket.start.nanoseconds, bucket.channel});
  return rows;
}

}  // namespace

void TierTable::put(const Tier& tier, std::span<const Bucket> buckets) {
  std::vector<SqlRow> rows;
  rows.reserve(buckets.size());
  for (const Bucket& bucket : buckets) rows.push_back(row_of(tier, bucket));
  connection_.execute(
      "insert into tiers (width, channel, start, count, bad, min, max, sum, first, last) "
      "values ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10) on conflict (width, channel, start) "
      "do update set count = excluded.count, bad = excluded.bad, min = excluded.min, "
      "max = excluded.max, sum = excluded.sum, first = excluded.first, last = excluded.last "
      "where excluded.count + excluded.bad > tiers.count + tiers.bad",
      rows);
}

void TierTable::read(const Tier& tier, std::int64_t channel, UtcTime from, UtcTime to,
                     const std::function<bool(const Bucket&)>& on_bucket) {
  connection_.query(
      "select start, count, bad, min, max, sum, first, last from tiers "
      "where width = $1 and channel = $2 and start >= $3 and start < $4 order by start",
      {tier.seconds(), channel, from.nanoseconds, to.nanoseconds}, [&](const SqlRow& row) {
        Bucket bucket{.channel = channel,
                      .start = {integer_at(row, 0)},
                      .count = static_cast<std::uint64_t>(integer_at(row, 1)),
                      .bad = static_cast<std::uint64_t>(integer_at(row, 2))};
        if (bucket.count > 0) {
          bucket.min = number_at(row, 3);
          bucket.max = number_at(row, 4);
          bucket.sum = number_at(row, 5);
          bucket.first = number_at(row, 6);
          bucket.last = number_at(row, 7);
        }
        return on_bucket(bucket);
      });
}

std::optional<UtcTime> TierTable::first(const Tier& tier, std::int64_t channel, UtcTime from,
                                        UtcTime to) {
  return time(
      "select min(start) from tiers where width = $1 and channel = $2 and start >= $3 and "
      "start < $4",
      {tier.seconds(), channel, from.nanoseconds, to.nanoseconds});
}

std::optional<UtcTime> TierTable::last(const Tier& tier, std::int64_t channel, UtcTime from,
                                       UtcTime to) {
  return time(
      "select max(start) from tiers where width = $1 and channel = $2 and start >= $3 and "
      "start < $4",
      {tier.seconds(), channel, from.nanoseconds, to.nanoseconds});
}

std::uint64_t TierTable::remove_before(const Tier& tier, std::int64_t channel, UtcTime before,
                                       std::uint64_t limit) {
  return connection_.execute(
      "delete from tiers where width = $1 and channel = $2 and start < $3 and start <= coalesce("
      "(select start from tiers where width = $4 and channel = $5 order by start limit 1 offset "
      "$6), $7)",
      SqlRow{tier.seconds(), channel, before.nanoseconds, tier.seconds(), channel,
             static_cast<std::int64_t>(limit), before.nanoseconds});
}

// The update of an existing note changes nothing but locks it: a concurrent transaction that writes
// the row then includes these samples.
void TierTable::note(const Tier& tier, std::span<const BucketKey> buckets) {
  connection_.execute(
      "insert into open_buckets (width, start, channel) values ($1, $2, $3) "
      "on conflict (width, start, channel) do update set channel = excluded.channel",
      rows_of(tier, buckets));
}

void TierTable::forget(const Tier& tier, std::span<const BucketKey> buckets) {
  connection_.execute("delete from open_buckets where width = $1 and start = $2 and channel = $3",
                      rows_of(tier, buckets));
}

std::vector<BucketKey> TierTable::noted(const Tier& tier, UtcTime before, std::int64_t limit) {
  std::vector<BucketKey> found;
  connection_.query(
      "select channel, start from open_buckets where width = $1 and start < $2 "
      "order by start, channel limit $3",
      {tier.seconds(), before.nanoseconds, limit}, [&](const SqlRow& row) {
        found.push_back({integer_at(row, 0), {integer_at(row, 1)}});
        return true;
      });
  return found;
}

std::optional<UtcTime> TierTable::oldest_noted(const Tier& tier) {
  return time("select min(start) from open_buckets where width = $1", {tier.seconds()});
}

std::optional<BucketKey> TierTable::next_untiered() {
  std::optional<BucketKey> found;
  connection_.query("select channel, next from untiered order by channel limit 1", {},
                    [&](const SqlRow& row) {
                      found = {integer_at(row, 0), {integer_at(row, 1)}};
                      return false;
                    });
  return found;
}

void TierTable::set_untiered(const BucketKey& next) {
  connection_.execute("update untiered set next = $1 where channel = $2",
                      SqlRow{next.start.nanoseconds, next.channel});
}

void TierTable::remove_untiered(std::int64_t channel) {
  connection_.execute("delete from untiered where channel = $1", SqlRow{channel});
}

bool TierTable::is_untiered(std::int64_t channel) {
  return time("select next from untiered where channel = $1", {channel}).has_value();
}

std::optional<UtcTime> TierTable::oldest_untiered() {
  return time("select min(next) from untiered", {});
}

// Returns the first column of the first row; `std::nullopt` if it is null or there is no row.
std::optional<UtcTime> TierTable::time(const std::string& sql, const SqlRow& parameters) {
  std::optional<UtcTime> found;
  connection_.query(sql, parameters, [&](const SqlRow& row) {
    if (std::holds_alternative<std::int64_t>(row.at(0))) found = UtcTime{integer_at(row, 0)};
    return true;
  });
  return found;
}

bool TierHistory::read(const StoredChannel& channel, UtcTime from, UtcTime to,
                       const OnBucket& on_bucket) {
  bucket_ = {.channel = channel.id};
  on_bucket_ = &on_bucket;
  wanted_ = true;
  from = bucket_start(from, every_);
  const UtcTime last = bucket_start({saturated_difference(to.nanoseconds, 1)}, every_);
  const bool ends = last.nanoseconds < kEndOfTime.nanoseconds - every_.count();
  to = ends ? UtcTime{last.nanoseconds + every_.count()} : kEndOfTime;
  const auto tier = tier_for(every_);
  // Samples stored by an older Fieldcast may have no tiers yet.
  const bool tiered = tier && !tiers_.is_untiered(channel.id);
  read_levels(tiered ? *tier + 1 : 0, channel.id, from, to);
  finish();
  return wanted_;
}

void TierHistory::read_levels(std::size_t levels, std::int64_t channel, UtcTime from, UtcTime to) {
  if (!wanted_ || from >= to) return;
  if (levels == 0) return read_samples(channel, from, to);
  const Tier& tier = kTiers[levels - 1];
  const auto first = tiers_.first(tier, channel, from, to);
  const auto last = tiers_.last(tier, channel, from, to);
  if (!first || !last) return read_levels(levels - 1, channel, from, to);
  const UtcTime end{saturated_sum(last->nanoseconds, tier.width.count())};
  read_levels(levels - 1, channel, from, *first);
  read_tier(levels, channel, *first, end);
  read_levels(levels - 1, channel, end, to);
}

void TierHistory::read_tier(std::size_t levels, std::int64_t channel, UtcTime from, UtcTime to) {
  tiers_.read(kTiers[levels - 1], channel, from, to, [&](const Bucket& row) {
    bucket_at(row.start).append(row);
    return wanted_;
  });
}

void TierHistory::read_samples(std::int64_t channel, UtcTime from, UtcTime to) {
  samples_.numbers(channel, from, to, SampleTable::kNoLimit,
                   [&](UtcTime at, Quality quality, const Value& value) {
                     bucket_at(at).add(quality, value);
                     return wanted_;
                   });
}

Bucket& TierHistory::bucket_at(UtcTime at) {
  const UtcTime start = bucket_start(at, every_);
  if (start != bucket_.start) {
    finish();
    bucket_ = {.channel = bucket_.channel, .start = start};
  }
  return bucket_;
}

void TierHistory::finish() {
  if (wanted_ && !bucket_.empty()) wanted_ = (*on_bucket_)(bucket_);
  bucket_ = {.channel = bucket_.channel};
}

std::optional<TierHistory::Reach> TierHistory::reach(const StoredChannel& channel) {
  const auto tier = tier_for(every_);
  const std::size_t levels = tier ? *tier + 1 : 0;
  auto oldest = samples_.oldest(channel.id);
  for (std::size_t i = 0; i < levels; ++i) {
    const auto first = tiers_.first(kTiers[i], channel.id, {}, kEndOfTime);
    if (first && (!oldest || *first < *oldest)) oldest = first;
  }
  for (std::size_t i = levels; i < kTiers.size(); ++i) {
    const auto first = tiers_.first(kTiers[i], channel.id, {}, kEndOfTime);
    if (!first) continue;
    const UtcTime known = oldest ? bucket_start(*oldest, kTiers[i].width) : kEndOfTime;
    if (*first < known) return Reach{oldest.value_or(kEndOfTime), i, *first};
  }
  return std::nullopt;
}

}  // namespace fieldcast
