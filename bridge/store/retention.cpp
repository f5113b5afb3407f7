#include "bridge/store/retention.hpp"

#include <algorithm>

#include "bridge/store/event_table.hpp"
#include "bridge/store/tiers/sample_days.hpp"
#include "bridge/store/tiers/sample_table.hpp"
#include "bridge/store/tiers/tier_table.hpp"
#include "core/base/time.hpp"

namespace fieldcast {
namespace {

// A store that is too large loses the oldest twentieth of its time span, repeatedly.
constexpr std::int64_t kShare = 20;

// 2026-01-01. An earlier clock was never set.
constexpr UtcTime kPlausible{1'767'225'600'000'000'000};

std::int64_t pragma(SqlConnection& connection, const char* name) {
  std::int64_t number = 0;
  connection.query(std::string("pragma ") + name, {}, [&](const SqlRow& row) {
    number = integer_at(row, 0);
    return false;
  });
  return number;
}

bool is_server(SqlConnection& connection) {
  return connection.dialect() == SqlConnection::Dialect::kPostgres;
}

// Size that max-size limits: used pages of a file; on a server the tables of the days.
std::uint64_t bytes_used(SqlConnection& connection) {
  if (is_server(connection)) return SampleDays(connection).bytes();
  const std::int64_t pages =
      pragma(connection, "page_count") - pragma(connection, "freelist_count");
  return static_cast<std::uint64_t>(pages * pragma(connection, "page_size"));
}

// Drops the days that ended before `before`. Returns their number.
std::uint64_t drop_days(SqlConnection& connection, UtcTime before) {
  SampleDays days(connection);
  std::uint64_t dropped = 0;
  for (const UtcTime day : days.all()) {
    if (day.nanoseconds + SampleDays::kDay.count() > before.nanoseconds) break;
    if (days.drop(day)) ++dropped;
  }
  return dropped;
}

// Free pages beyond a tenth of the file are returned to the disk, some at a time.
constexpr std::int64_t kFreeShare = 10;
constexpr std::int64_t kFreePages = 256;  // the minimum: a megabyte
constexpr const char* kShrink = "pragma incremental_vacuum(512)";
constexpr std::int64_t kIncremental = 2;  // sqlite.org/pragma.html, auto_vacuum

// Shortens the file a little. Returns false if it has few free pages, or if an older Fieldcast
// created it, whose files cannot shrink.
bool shrink(SqlConnection& connection) {
  if (is_server(connection)) return false;
  const std::int64_t free = pragma(connection, "freelist_count");
  if (free <= kFreePages || free * kFreeShare <= pragma(connection, "page_count")) return false;
  if (pragma(connection, "auto_vacuum") != kIncremental) return false;
  connection.script(kShrink);
  return true;
}

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

// Returns the start of the rows that are still needed to make tiers, or `std::nullopt` if none are.
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
    if (shrinking_ && (shrinking_ = shrink(connection))) return true;
    if (now < next_pass_ && !too_large_) return false;
    next_pass_ = now + kPause;
    begin(connection, follow(connection, now, utc));
  }
  std::uint64_t removed = 0;
  std::size_t looked = 0;
  for (; looked < kChannelsAtOnce && removed < kAtOnce && find_next(); ++looked) {
    const std::uint64_t gone = remove(connection);
    if (gone < kAtOnce) ++channel_;
    removed += gone;
  }
  removed_ += removed;
  if (find_next()) return true;
  // After a pass that removed nothing: other data than samples fills the store.
  too_large_ = too_large_ && removed_ > 0;
  shrinking_ = shrink(connection);
  return looked > 0 || shrinking_ || too_large_;
}

// Finds the next channel to remove rows from. Returns false at the end of the pass.
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

UtcTime Retention::follow(SqlConnection& connection, Instant now, UtcTime utc) {
  if (!followed_) {
    connection.query("select at from retention_clock", {}, [&](const SqlRow& row) {
      clock_ = stored_clock_ = {integer_at(row, 0)};
      return false;
    });
  }
  const Duration ran = kFastest * (followed_ ? now - *followed_ : kPause);
  followed_ = now;
  const UtcTime reached{std::min(utc.nanoseconds, saturated_sum(clock_.nanoseconds, ran.count()))};
  clock_ = clock_ < kPlausible ? utc : std::max(clock_, reached);
  if (saturated_difference(clock_.nanoseconds, stored_clock_.nanoseconds) >= kClockStep.count()) {
    connection.execute("update retention_clock set at = $1 where at < $1",
                       SqlRow{clock_.nanoseconds});
    stored_clock_ = clock_;
  }
  return std::min(clock_, utc);
}

void Retention::begin(SqlConnection& connection, UtcTime utc) {
  EventTable(connection).remove_oldest();
  channels_ = SampleTable(connection).channel_ids();
  level_ = channel_ = 0;
  removed_ = 0;
  too_large_ = spec_.max_bytes != 0 && bytes_used(connection) > spec_.max_bytes;
  for (std::size_t level = 0; level < kLevels; ++level)
    before_[level] = limit_of(connection, level, utc);
  if (is_server(connection)) begin_days(connection);
}

// On a server, whole days are dropped; single samples if in no day or kept for under two days.
void Retention::begin_days(SqlConnection& connection) {
  removed_ += drop_days(connection, before_[0]);
  const bool short_time = spec_.keep != Duration{} && spec_.keep < 2 * SampleDays::kDay;
  if (!short_time) {
    before_[0] = SampleDays(connection).has_undated() ? bucket_start(before_[0], SampleDays::kDay)
                                                      : UtcTime{};
  }
}

UtcTime Retention::limit_of(SqlConnection& connection, std::size_t level, UtcTime utc) const {
  const Duration keep = level == 0 ? spec_.keep : spec_.*kTiers[level - 1].keep;
  UtcTime before{keep == Duration{} ? 0 : utc.nanoseconds - keep.count()};
  if (too_large_ && is_server(connection)) {
    const auto days = SampleDays(connection).all();
    if (level == 0 && !days.empty())
      before.nanoseconds = std::max(
          before.nanoseconds, saturated_sum(days.front().nanoseconds, SampleDays::kDay.count()));
  } else if (too_large_) {
    const auto oldest = oldest_of(connection, level, channels_);
    if (oldest && *oldest < utc) {
      const std::int64_t span =
          std::max(saturated_difference(utc.nanoseconds, oldest->nanoseconds), kShare);
      before.nanoseconds = std::max(before.nanoseconds, oldest->nanoseconds + span / kShare);
    }
  }
  if (before > utc) before = utc;  // the day has not ended
  const auto needed = needed_from(connection, level);
  return needed ? std::min(before, *needed) : before;
}

}  // namespace fieldcast
