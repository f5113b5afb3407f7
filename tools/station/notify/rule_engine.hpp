// Decides which messages are due, from the states of alarms and the time. Pure; one owner.
//
// For each rule and alarm: waiting (delay, hours) -> first message -> repeats and escalations until
// it is acknowledged -> message of its end -> closed. A message has the same id whenever it is
// derived from the same occurrence, and the progress is restored after a restart, so that nothing
// is sent twice. A shelved or suppressed alarm waits.
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "bridge/store/records/notification_records.hpp"
#include "tools/station/notify/notify_spec.hpp"

namespace fieldcast::web {

enum class NotifyKind : std::uint8_t { kRaised, kRepeated, kEscalated, kCleared, kDigest };
[[nodiscard]] std::string_view to_text(NotifyKind kind);  // "raised", ...

struct NotifyMessage {
  std::string id;
  NotifyKind kind = NotifyKind::kRaised;
  std::string rule, target;
  UtcTime at;
  AlarmKey alarm;            // not of a digest
  AlarmStatus status;        // not of a digest
  std::uint32_t number = 0;  // of this alarm's messages, from 1
  std::string lines;         // of a digest
  std::uint32_t more = 0;
};

class RuleEngine {
 public:
  static constexpr std::size_t kMaxAlarms = 50'000;  // further alarms are ignored
  static constexpr std::size_t kMaxLines = 100;      // of a digest
  // An alarm that returned while nobody saw it is reported unless it is older.
  static constexpr Duration kOldest = std::chrono::hours{24};

  explicit RuleEngine(std::vector<NotifyRule> rules) : rules_(std::move(rules)) {}

  // Continues after a restart. Rows of rules that no longer exist are ignored.
  void restore(const std::vector<NotifyProgress>& progress,
               const std::vector<NotifyWindow>& windows);

  void on_alarm(const AlarmKey& alarm, const AlarmStatus& status, UtcTime now);

  // `progress` and `windows` replace the stored rows; store them together with the messages.
  struct Due {
    std::vector<NotifyMessage> messages;
    std::vector<NotifyProgress> progress;
    std::vector<NotifyWindow> windows;
    [[nodiscard]] bool empty() const {
      return messages.empty() && progress.empty() && windows.empty();
    }
  };
  // Call once a second. `local` is `now` in local time.
  [[nodiscard]] Due due(UtcTime now, const LocalMinute& local);

 private:
  struct Seen {
    AlarmStatus status;
    UtcTime at;  // when this occurrence was first seen
    std::vector<std::size_t> rules;
  };
  using Key = std::pair<std::size_t, AlarmKey>;           // rule, alarm
  using WindowKey = std::pair<std::size_t, std::string>;  // rule, target
  struct Turn {
    std::size_t rule;
    const AlarmKey& alarm;
    const Seen& seen;
    UtcTime now;
    bool may_send;
  };

  void settle(std::size_t rule, const AlarmKey& alarm, const Seen& seen, bool continues);
  // Both return whether the alarm must be looked at again without a new status.
  [[nodiscard]] bool begin(const Turn& turn);
  [[nodiscard]] bool proceed(const Turn& turn, NotifyProgress& progress);
  void send_escalations(const Turn& turn, NotifyProgress& progress);
  void send(const Turn& turn, const NotifyProgress& progress, NotifyKind kind,
            const std::vector<std::string>& targets, std::uint32_t number);
  [[nodiscard]] bool collect(const Turn& turn, NotifyKind kind, const std::string& target);
  void end_windows(UtcTime now);
  [[nodiscard]] std::vector<std::string> informed(std::size_t rule, const NotifyProgress& progress);

  const std::vector<NotifyRule> rules_;
  std::map<AlarmKey, Seen> alarms_;
  std::set<AlarmKey> open_;  // to look at again
  std::map<Key, NotifyProgress> progress_;
  std::map<WindowKey, NotifyWindow> windows_;
  std::set<Key> changed_;
  std::set<WindowKey> changed_windows_;
  std::vector<NotifyMessage> messages_;
};

}  // namespace fieldcast::web
