#include "tools/station/notify/notifier.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "bridge/base/clock.hpp"
#include "bridge/log/log.hpp"
#include "tools/station/notify/delivery.hpp"
#include "tools/station/notify/message_text.hpp"

namespace fieldcast::web {
namespace {

constexpr std::chrono::seconds kTurn{1};              // period of the rules
constexpr std::chrono::milliseconds kLook{250};       // of new messages
constexpr Duration kIdle = std::chrono::seconds{10};  // until the store is read without news
constexpr Duration kFirstPause = std::chrono::seconds{2};
constexpr Duration kLongestTargetPause = std::chrono::minutes{1};  // of a target
constexpr Duration kTidy = std::chrono::minutes{1};

UtcTime utc_now() { return read_clocks().utc; }

}  // namespace

Duration pause_after(std::uint32_t failures, Duration longest) {
  return std::min(longest, kFirstPause * (1 << std::min(failures, 16u)));
}

Notifier::Notifier(NotifySpec spec, std::string station, const StoreAddress& store,
                   std::function<bool()> alive)
    : spec_(std::move(spec)),
      station_(std::move(station)),
      alive_(std::move(alive)),
      outbox_(store, spec_.queue, spec_.keep),
      rules_("notify", kMaxWaiting,
             [this](BoundedQueue<StationAlarmStatus>& queue) { apply_rules(queue); }) {
  for (const NotifyTarget& target : spec_.targets) {
    {
      const std::lock_guard lock(mutex_);
      states_[target.name] = {target.name, !target.mail.empty(), {}, {}};
    }
    senders_.push_back(std::make_unique<Worker<Nothing>>(
        "notify-send", 1, [this, &target](BoundedQueue<Nothing>& queue) { send(target, queue); }));
  }
  if (!spec_.heartbeat.http.server.empty() || !spec_.heartbeat.url_file.empty())
    senders_.push_back(std::make_unique<Worker<Nothing>>(
        "notify-beat", 1, [this](BoundedQueue<Nothing>& queue) { send_heartbeats(queue); }));
}

Notifier::~Notifier() {
  over_at_ = steady_now() + kFarewell;
  for (const auto& sender : senders_) sender->queue().close();
  rules_.close();
}

bool Notifier::is_over() const { return steady_now() > over_at_.load(); }

void Notifier::on_alarm(const StationAlarmStatus& alarm) { rules_.queue().put_newest(alarm); }

void Notifier::apply_rules(BoundedQueue<StationAlarmStatus>& queue) {
  RuleEngine engine(spec_.rules);
  bool restored = false;
  std::map<AlarmKey, AlarmStatus> early;  // statuses before the progress is restored
  RuleEngine::Due pending;
  std::vector<Notification> rows;
  UtcTime tidied;
  while (!queue.closed()) {
    const auto statuses = queue.take_all(std::chrono::steady_clock::now() + kTurn);
    const UtcTime now = utc_now();
    if (!restored) {
      for (const auto& [alarm, status] : statuses) early[alarm] = status;
      const auto kept = outbox_.load();
      if (!kept) continue;
      engine.restore(kept->progress, kept->windows);
      restored = true;
      for (const auto& [alarm, status] : early) engine.on_alarm(alarm, status, now);
      early.clear();
    } else {
      for (const auto& [alarm, status] : statuses) engine.on_alarm(alarm, status, now);
    }
    // While the store is not available, the rules wait with it.
    if (pending.empty()) {
      pending = engine.due(now, local_minute(now));
      for (const NotifyMessage& message : pending.messages) {
        auto more = rows_of(message, spec_, station_);
        std::move(more.begin(), more.end(), std::back_inserter(rows));
      }
    }
    if (!pending.empty() && outbox_.commit(pending, rows, now)) {
      rows.clear();
      pending = {};
    }
    if (std::chrono::abs(Duration{now.nanoseconds - tidied.nanoseconds}) >= kTidy) {
      tidied = now;
      outbox_.tidy(now);
    }
  }
}

void Notifier::send(const NotifyTarget& target, BoundedQueue<Nothing>& queue) {
  std::uint64_t generation = 0;
  std::uint32_t failures = 0;
  Instant look_at = steady_now();
  while (!queue.closed()) {
    const bool news = failures == 0 && outbox_.generation() != generation;
    if (!news && steady_now() < look_at) {
      (void)queue.pause(kLook);
      continue;
    }
    generation = outbox_.generation();
    const auto delivered = send_next(target);
    if (!delivered) {
      look_at = steady_now() + kIdle;
    } else if (*delivered) {
      failures = 0;
      look_at = steady_now();
    } else {
      look_at = steady_now() + pause_after(failures++, kLongestTargetPause);
    }
  }
}

std::optional<bool> Notifier::send_next(const NotifyTarget& target) {
  const auto message = outbox_.next(target.name, utc_now());
  if (!message) return std::nullopt;
  const auto delivered = deliver(spec_.mail, target, *message, [this] { return is_over(); });
  const UtcTime now = utc_now();
  note(target.name, delivered ? "" : delivered.error(), now);
  if (delivered)
    outbox_.sent(message->id, now);
  else
    outbox_.failed(message->id, delivered.error(),
                   {now.nanoseconds +
                    pause_after(message->attempts, NotificationTable::kLongestPause).count()});
  return delivered.has_value();
}

void Notifier::note(const std::string& target, const std::string& error, UtcTime now) {
  const std::lock_guard lock(mutex_);
  TargetState& state = states_[target];
  const std::string before = std::exchange(state.error, error);
  if (error.empty()) state.sent_at = now;
  if (before == error) return;
  if (error.empty())
    log_info("notify", fmt::format("{}: messages are delivered again", target));
  else
    log_warning("notify", fmt::format("{}: a message was not delivered: {}", target, error));
}

void Notifier::send_heartbeats(BoundedQueue<Nothing>& queue) {
  std::string before;
  do {
    if (!alive_()) continue;
    const auto sent = beat(spec_.heartbeat, station_, [this] { return is_over(); });
    ++(sent ? beats_ : failed_beats_);
    std::string error = sent ? "" : sent.error();
    if (!error.empty() && error != before) log_warning("notify", "heartbeat: " + error);
    before = std::move(error);
  } while (!queue.pause(spec_.heartbeat.every));
}

bool Notifier::has_target(const std::string& target) const {
  return std::ranges::find(spec_.targets, target, &NotifyTarget::name) != spec_.targets.end();
}

bool Notifier::queue_test(const std::string& target) {
  const auto found = std::ranges::find(spec_.targets, target, &NotifyTarget::name);
  const UtcTime now = utc_now();
  return outbox_.commit({}, {test_row(*found, station_, now)}, now);
}

Notifier::Report Notifier::report() const {
  Report report{outbox_.counters(), {}, beats_, failed_beats_};
  const std::lock_guard lock(mutex_);
  for (const auto& [name, state] : states_) report.targets.push_back(state);
  return report;
}

}  // namespace fieldcast::web
