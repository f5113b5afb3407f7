#include "bridge/store/retention.hpp"

#include <algorithm>

#include "bridge/store/event_table.hpp"
#include "bridge/store/sample_table.hpp"

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

}  // namespace

bool Retention::step(SqlConnection& connection, Instant now, UtcTime utc) {
  if (channels_.empty()) {
    if (now < next_pass_ && !too_large_) return false;
    next_pass_ = now + kPause;
    begin(connection, utc);
    if (channels_.empty()) return false;
  }
  if (SampleTable(connection).remove_before(channels_.back(), before_, kAtOnce) < kAtOnce)
    channels_.pop_back();
  return true;
}

void Retention::begin(SqlConnection& connection, UtcTime utc) {
  SampleTable samples(connection);
  EventTable(connection).remove_oldest();
  before_ = UtcTime{spec_.keep == Duration{} ? 0 : utc.nanoseconds - spec_.keep.count()};
  channels_ = samples.channel_ids();
  too_large_ = spec_.max_bytes != 0 && connection.dialect() == SqlConnection::Dialect::kSqlite &&
               bytes_used(connection) > spec_.max_bytes;
  if (too_large_) {
    std::int64_t oldest = utc.nanoseconds;
    for (const std::int64_t channel : channels_) {
      const std::int64_t first = samples.oldest(channel).nanoseconds;
      if (first != 0) oldest = std::min(oldest, first);
    }
    const std::int64_t span = std::max<std::int64_t>(utc.nanoseconds - oldest, kShare);
    before_.nanoseconds = std::max(before_.nanoseconds, oldest + span / kShare);
    too_large_ = oldest < utc.nanoseconds;  // else it is not the samples that fill it
  }
  if (before_.nanoseconds == 0) channels_.clear();
}

}  // namespace fieldcast
