#include "bridge/store/notification_table.hpp"

namespace fieldcast {
namespace {

using State = NotifyProgress::State;
using Return = NotifyProgress::Return;

std::uint32_t count_at(const SqlRow& row, std::size_t column) {
  return static_cast<std::uint32_t>(integer_at(row, column));
}

UtcTime when_at(const SqlRow& row, std::size_t column) { return {integer_at(row, column)}; }

}  // namespace

std::vector<NotifyProgress> NotificationTable::progress() {
  std::vector<NotifyProgress> all;
  connection_.query(
      "select rule, bus, device, channel, limit_kind, state, occurrence, first_at, last_at, count, "
      "escalated, returned from notify_progress",
      {}, [&](const SqlRow& row) {
        const auto limit = limit_kind_from(text_at(row, 4));
        if (!limit) return true;
        all.push_back({.rule = text_at(row, 0),
                       .alarm = {text_at(row, 1), text_at(row, 2), text_at(row, 3), *limit},
                       .state = static_cast<State>(integer_at(row, 5)),
                       .occurrence = when_at(row, 6),
                       .first_at = when_at(row, 7),
                       .last_at = when_at(row, 8),
                       .count = count_at(row, 9),
                       .escalated = count_at(row, 10),
                       .returned = static_cast<Return>(integer_at(row, 11))});
        return true;
      });
  return all;
}

std::vector<NotifyWindow> NotificationTable::windows() {
  std::vector<NotifyWindow> all;
  connection_.query("select rule, target, start, count, lines, more from notify_windows", {},
                    [&](const SqlRow& row) {
                      all.push_back({text_at(row, 0), text_at(row, 1), when_at(row, 2),
                                     count_at(row, 3), text_at(row, 4), count_at(row, 5)});
                      return true;
                    });
  return all;
}

void NotificationTable::put(const NotifyProgress& progress) {
  const AlarmKey& alarm = progress.alarm;
  connection_.execute(
      "insert into notify_progress (rule, bus, device, channel, limit_kind, state, occurrence, "
      "first_at, last_at, count, escalated, returned) values ($1, $2, $3, $4, $5, $6, $7, $8, $9, "
      "$10, $11, $12) on conflict (rule, bus, device, channel, limit_kind) do update set state = "
      "excluded.state, occurrence = excluded.occurrence, first_at = excluded.first_at, last_at = "
      "excluded.last_at, count = excluded.count, escalated = excluded.escalated, returned = "
      "excluded.returned",
      SqlRow{progress.rule, alarm.bus, alarm.device, alarm.channel,
             std::string(to_text(alarm.limit)), std::int64_t{static_cast<int>(progress.state)},
             progress.occurrence.nanoseconds, progress.first_at.nanoseconds,
             progress.last_at.nanoseconds, std::int64_t{progress.count},
             std::int64_t{progress.escalated}, std::int64_t{static_cast<int>(progress.returned)}});
}

void NotificationTable::put(const NotifyWindow& window) {
  if (window.start.nanoseconds == 0) {
    connection_.execute("delete from notify_windows where rule = $1 and target = $2",
                        SqlRow{window.rule, window.target});
    return;
  }
  connection_.execute(
      "insert into notify_windows (rule, target, start, count, lines, more) values ($1, $2, $3, "
      "$4, $5, $6) on conflict (rule, target) do update set start = excluded.start, count = "
      "excluded.count, lines = excluded.lines, more = excluded.more",
      SqlRow{window.rule, window.target, window.start.nanoseconds, std::int64_t{window.count},
             window.lines, std::int64_t{window.more}});
}

void NotificationTable::put(const Notification& message) {
  connection_.execute(
      "insert into notifications (id, target, recipient, made_at, subject, content, json, "
      "attachment_name, attachment, state, attempts, next_at, done_at, error) values ($1, $2, $3, "
      "$4, $5, $6, $7, $8, $9, 'waiting', 0, $4, 0, '') on conflict (id) do nothing",
      SqlRow{message.id, message.target, message.recipient, message.made_at.nanoseconds,
             message.subject, message.text, message.json, message.attachment_name,
             message.attachment});
}

std::uint64_t NotificationTable::waiting() {
  std::int64_t count = 0;
  connection_.query("select count(*) from notifications where state = 'waiting'", {},
                    [&](const SqlRow& row) {
                      count = integer_at(row, 0);
                      return false;
                    });
  return static_cast<std::uint64_t>(count);
}

std::uint64_t NotificationTable::drop_oldest(std::uint64_t most, UtcTime now) {
  const std::uint64_t present = waiting();
  if (present <= most) return 0;
  return connection_.execute(
      "update notifications set state = 'dropped', done_at = $1, error = 'the queue was full' "
      "where id in (select id from notifications where state = 'waiting' order by made_at, id "
      "limit $2)",
      SqlRow{now.nanoseconds, static_cast<std::int64_t>(present - most)});
}

std::uint64_t NotificationTable::expire(UtcTime oldest, UtcTime now) {
  return connection_.execute(
      "update notifications set state = 'expired', done_at = $1 where state = 'waiting' and "
      "made_at < $2",
      SqlRow{now.nanoseconds, oldest.nanoseconds});
}

std::optional<QueuedNotification> NotificationTable::next(const std::string& target, UtcTime now) {
  std::optional<QueuedNotification> found;
  connection_.query(
      "select id, recipient, made_at, subject, content, json, attempts, attachment_name, "
      "attachment from notifications where state = 'waiting' and target = $1 and "
      "(next_at <= $2 or next_at > $3) order by next_at, made_at, id limit 1",
      {target, now.nanoseconds, now.nanoseconds + kLongestPause.count()}, [&](const SqlRow& row) {
        QueuedNotification& message = found.emplace();
        message.id = text_at(row, 0);
        message.target = target;
        message.recipient = text_at(row, 1);
        message.made_at = when_at(row, 2);
        message.subject = text_at(row, 3);
        message.text = text_at(row, 4);
        message.json = text_at(row, 5);
        message.attempts = count_at(row, 6);
        message.attachment_name = text_at(row, 7);
        message.attachment = text_at(row, 8);
        return false;
      });
  return found;
}

void NotificationTable::sent(const std::string& id, UtcTime now) {
  connection_.execute(
      "update notifications set state = 'sent', attempts = attempts + 1, done_at = $1, error = '', "
      "attachment = '' where id = $2",
      SqlRow{now.nanoseconds, id});
}

void NotificationTable::failed(const std::string& id, const std::string& error, UtcTime next_at) {
  connection_.execute(
      "update notifications set attempts = attempts + 1, next_at = $1, error = $2 where id = $3",
      SqlRow{next_at.nanoseconds, error, id});
}

std::vector<QueuedNotification> NotificationTable::newest(std::int64_t limit) {
  std::vector<QueuedNotification> all;
  connection_.query(
      "select id, target, recipient, made_at, subject, state, attempts, done_at, error from "
      "notifications order by made_at desc, id limit $1",
      {limit}, [&](const SqlRow& row) {
        QueuedNotification& message = all.emplace_back();
        message.id = text_at(row, 0);
        message.target = text_at(row, 1);
        message.recipient = text_at(row, 2);
        message.made_at = when_at(row, 3);
        message.subject = text_at(row, 4);
        message.state = text_at(row, 5);
        message.attempts = count_at(row, 6);
        message.done_at = when_at(row, 7);
        message.error = text_at(row, 8);
        return true;
      });
  return all;
}

void NotificationTable::remove_old(UtcTime now) {
  connection_.execute("delete from notifications where state <> 'waiting' and done_at < $1",
                      SqlRow{now.nanoseconds - kKept.count()});
  connection_.execute("delete from notify_progress where state = $1 and last_at < $2",
                      SqlRow{std::int64_t{static_cast<int>(State::kClosed)},
                             now.nanoseconds - kKeptProgress.count()});
}

}  // namespace fieldcast
