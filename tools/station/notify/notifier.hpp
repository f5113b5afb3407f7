// Notifies of alarms: one thread applies the rules, one for each target sends, and one sends the
// heartbeat. Nothing is sent before the store has it. The store must exist.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "bridge/base/worker.hpp"
#include "bridge/dds/topics/topic_values.hpp"
#include "tools/station/notify/outbox.hpp"

namespace fieldcast::web {

// The pause after `failures` failures in a row: doubled each time, at most `longest`.
[[nodiscard]] Duration pause_after(std::uint32_t failures, Duration longest);

class Notifier {
 public:
  static constexpr std::size_t kMaxWaiting = 100'000;  // statuses; the oldest are dropped

  static constexpr Duration kFarewell = std::chrono::seconds{2};

  // `alive`: whether the station works; without it no heartbeat is sent. Any thread.
  Notifier(NotifySpec spec, std::string station, const StoreAddress& store,
           std::function<bool()> alive);
  ~Notifier();  // waits up to kFarewell, and a second, for messages in flight
  Notifier(const Notifier&) = delete;
  Notifier& operator=(const Notifier&) = delete;

  // Any thread; never blocks.
  void on_alarm(const StationAlarmStatus& alarm);

  struct TargetState {
    std::string name;
    bool is_mail = false;
    UtcTime sent_at;    // 0: nothing since the start
    std::string error;  // of the last attempt; empty: it succeeded
  };
  struct Report {
    Outbox::Counters counters;
    std::vector<TargetState> targets;
    std::uint64_t beats = 0, failed_beats = 0;
  };
  [[nodiscard]] Report report() const;  // any thread
  [[nodiscard]] const std::vector<NotifyRule>& rules() const { return spec_.rules; }

  // Puts a test message for the first recipient of a target into the queue. Returns false if the
  // store is not available now. REQUIRES: has_target(). Any thread; waits for the database.
  [[nodiscard]] bool queue_test(const std::string& target);
  [[nodiscard]] bool has_target(const std::string& target) const;

 private:
  struct Nothing {};
  void apply_rules(BoundedQueue<StationAlarmStatus>& queue);
  void send(const NotifyTarget& target, BoundedQueue<Nothing>& queue);
  // Returns whether a message was delivered; empty if none is due.
  [[nodiscard]] std::optional<bool> send_next(const NotifyTarget& target);
  [[nodiscard]] bool is_over() const;
  void note(const std::string& target, const std::string& error, UtcTime now);
  void send_heartbeats(BoundedQueue<Nothing>& queue);

  const NotifySpec spec_;
  const std::string station_;
  const std::function<bool()> alive_;
  Outbox outbox_;
  mutable std::mutex mutex_;
  std::map<std::string, TargetState> states_;
  std::atomic<Instant> over_at_{kNever};  // messages in flight are given up
  std::atomic<std::uint64_t> beats_{0}, failed_beats_{0};
  // Last: their threads use the members above.
  std::vector<std::unique_ptr<Worker<Nothing>>> senders_;
  Worker<StationAlarmStatus> rules_;
};

}  // namespace fieldcast::web
