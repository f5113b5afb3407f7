#include "bridge/store/tiers/tier_history.hpp"

#include "core/base/time.hpp"

namespace fieldcast {

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
