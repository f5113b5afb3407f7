#include "bridge/store/retention.hpp"

#include <algorithm>

#include "bridge/store/event_table.hpp"
#include "bridge/store/sample_table.hpp"
#include "bridge/store/tiers/tier_table.hpp"

namespace fieldcast {
namespace {

// A store that is too large loses its oldest twentieth of time, again and again.
constexpr std::int64_t kShare = 20;

std::int64_t pragma(SqlConnection& connection, const char* name) {
  std::int64_t number = 0;
  connection.query(std::string("pragma ") + name, {}, [&](const SqlRow& row) {
    number = integer_at(row, 0);
    return false;
  });
  return number;
}

// What the tables take; the file itself never shrinks, its free pages are used again.
std::uint64_t bytes_used(SqlConnection& connection) {
  const std::int64_t pages =
      pragma(connection, "page_count") - pragma(connection, "freelist_count");
  return static_cast<std::uint64_t>(pages * pragma(connection, "page_size"));
}

// The oldest row of any channel; nothing: there is none.
std::optional<UtcTime> oldest_of(SqlConnection& connection, std::size_t level,
                                 const std::vector<std::int64_t>& channels) {
  std::optional<UtcTime> oldest;
  for (const std::int64_t channel : channels) {
    const auto first =
        level == 0 ? SampleTable(connection).oldest(channel)
                   : TierTable(connection).first(kTiers[level - 1], channel, {}, kEndOfTime);
    if (first && (!oldest || *first < *oldest)) oldest = first;
  }
  return oldest;
}

// What is older was used for its tiers; nothing: all was.
std::optional<UtcTime> needed_from(SqlConnection& connection, std::size_t level) {
  TierTable tiers(connection);
  if (level == kTiers.size()) return std::nullopt;  // no tier is made from the last one
  auto needed = tiers.oldest_noted(kTiers[level]);
  if (level > 0) return needed;
  const auto untiered = tiers.oldest_untiered();
  return untiered && (!needed || *untiered < *needed) ? untiered : needed;
}

}  // namespace

bool Retention::step(SqlConnection& connection, Instant now, UtcTime utc) {
  if (level_ == kLevels) {
    if (now < next_pass_ && !too_large_) return false;
    next_pass_ = now + kPause;
    begin(connection, utc);
  }
  std::uint64_t removed = 0;
  std::size_t looked = 0;
  for (; looked < kChannelsAtOnce && removed < kAtOnce && find_next(); ++looked) {
    const std::uint64_t gone = remove(connection);
    if (gone < kAtOnce) ++channel_;
    removed += gone;
  }
  removed_ += removed;
  // At the end of a pass that removed nothing: it is not the samples that fill the store.
  if (!find_next()) too_large_ = too_large_ && removed_ > 0;
  return looked > 0;
}

// The next channel from which something may be removed. False: the pass has ended.
bool Retention::find_next() {
  while (level_ < kLevels && (before_[level_] <= UtcTime{} || channel_ == channels_.size())) {
    ++level_;
    channel_ = 0;
  }
  return level_ < kLevels;
}

std::uint64_t Retention::remove(SqlConnection& connection) {
  const std::int64_t channel = channels_[channel_];
  return level_ == 0 ? SampleTable(connection).remove_before(channel, before_[0], kAtOnce)
                     : TierTable(connection)
                           .remove_before(kTiers[level_ - 1], channel, before_[level_], kAtOnce);
}

void Retention::begin(SqlConnection& connection, UtcTime utc) {
  EventTable(connection).remove_oldest();
  channels_ = SampleTable(connection).channel_ids();
  level_ = channel_ = 0;
  removed_ = 0;
  too_large_ = spec_.max_bytes != 0 && connection.dialect() == SqlConnection::Dialect::kSqlite &&
               bytes_used(connection) > spec_.max_bytes;
  for (std::size_t level = 0; level < kLevels; ++level)
    before_[level] = limit_of(connection, level, utc);
}

UtcTime Retention::limit_of(SqlConnection& connection, std::size_t level, UtcTime utc) const {
  const Duration keep = level == 0 ? spec_.keep : spec_.*kTiers[level - 1].keep;
  UtcTime before{keep == Duration{} ? 0 : utc.nanoseconds - keep.count()};
  if (too_large_) {
    const auto oldest = oldest_of(connection, level, channels_);
    if (oldest && *oldest < utc) {
      const std::int64_t span = std::max(utc.nanoseconds - oldest->nanoseconds, kShare);
      before.nanoseconds = std::max(before.nanoseconds, oldest->nanoseconds + span / kShare);
    }
  }
  const auto needed = needed_from(connection, level);
  return needed ? std::min(before, *needed) : before;
}

}  // namespace fieldcast
