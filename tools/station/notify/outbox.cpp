#include "tools/station/notify/outbox.hpp"

#include <fmt/format.h>

#include "bridge/log/log.hpp"

namespace fieldcast::web {

bool Outbox::attempt(const std::function<void(NotificationTable&)>& action) {
  try {
    if (!connection_) connection_ = open_store(address_, IfMissing::kCreate);
    SqlTransaction transaction(*connection_);
    NotificationTable table(*connection_);
    action(table);
    waiting_ = table.waiting();
    transaction.commit();
    logged_.clear();
    return true;
  } catch (const StoreError& error) {
    connection_.reset();
    if (logged_ != error.what()) {
      logged_ = error.what();
      log_error("notify", logged_);
    }
    return false;
  }
}

std::optional<Outbox::Kept> Outbox::load() {
  const std::lock_guard lock(mutex_);
  Kept kept;
  const auto read = [&](NotificationTable& table) { kept = {table.progress(), table.windows()}; };
  if (!attempt(read)) return std::nullopt;
  ++generation_;
  return kept;
}

bool Outbox::commit(const RuleEngine::Due& due, const std::vector<Notification>& messages,
                    UtcTime now) {
  const std::lock_guard lock(mutex_);
  std::uint64_t dropped = 0;
  const bool done = attempt([&](NotificationTable& table) {
    for (const Notification& message : messages) table.put(message);
    for (const NotifyProgress& progress : due.progress) table.put(progress);
    for (const NotifyWindow& window : due.windows) table.put(window);
    dropped = table.drop_oldest(most_, now);
  });
  if (!done) return false;
  count_lost(dropped, "the queue is full: the oldest were dropped");
  if (!messages.empty()) ++generation_;
  return true;
}

void Outbox::count_lost(std::uint64_t count, const char* reason) {
  if (count == 0) return;
  lost_ += count;
  log_error("notify", fmt::format("messages lost: {}; {}", count, reason));
}

void Outbox::tidy(UtcTime now) {
  const std::lock_guard lock(mutex_);
  std::uint64_t expired = 0;
  if (attempt([&](NotificationTable& table) {
        expired = table.expire({now.nanoseconds - keep_.count()}, now);
        table.remove_old(now);
      }))
    count_lost(expired, "they could not be sent in the time of 'keep'");
}

std::optional<QueuedNotification> Outbox::next(const std::string& target, UtcTime now) {
  const std::lock_guard lock(mutex_);
  std::optional<QueuedNotification> found;
  if (!attempt([&](NotificationTable& table) {
        for (const Sent& each : unsaved_) table.sent(each.id, each.at);
        found = table.next(target, now);
      }))
    return std::nullopt;
  unsaved_.clear();
  return found;
}

void Outbox::sent(const std::string& id, UtcTime now) {
  const std::lock_guard lock(mutex_);
  ++sent_;
  if (!attempt([&](NotificationTable& table) { table.sent(id, now); }))
    unsaved_.push_back({id, now});
}

void Outbox::failed(const std::string& id, const std::string& error, UtcTime next_at) {
  const std::lock_guard lock(mutex_);
  ++failed_;
  (void)attempt([&](NotificationTable& table) { table.failed(id, error, next_at); });
}

Outbox::Counters Outbox::counters() const { return {waiting_, sent_, failed_, lost_}; }

}  // namespace fieldcast::web
