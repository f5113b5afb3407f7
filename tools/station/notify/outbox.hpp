// The durable queue of messages, and the progress of the rules, in the store of the station. After
// a failure, the next call opens the store again. Thread-safe; a call waits for the database.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "bridge/store/notification_table.hpp"
#include "tools/station/notify/rule_engine.hpp"

namespace fieldcast::web {

class Outbox {
 public:
  Outbox(StoreAddress address, std::uint64_t most, Duration keep)
      : address_(std::move(address)), most_(most), keep_(keep) {}

  struct Kept {
    std::vector<NotifyProgress> progress;
    std::vector<NotifyWindow> windows;
  };
  // Empty if the store is not available now.
  [[nodiscard]] std::optional<Kept> load();
  // Stores all or nothing, and drops the oldest messages beyond the limit. Returns false if the
  // store is not available now.
  [[nodiscard]] bool commit(const RuleEngine::Due& due, const std::vector<Notification>& messages,
                            UtcTime now);
  // Ends messages that are too old, and removes old rows.
  void tidy(UtcTime now);

  // Empty if nothing is due, or the store is not available now, or it has not stored yet that an
  // earlier message was sent.
  [[nodiscard]] std::optional<QueuedNotification> next(const std::string& target, UtcTime now);
  void sent(const std::string& id, UtcTime now);
  void failed(const std::string& id, const std::string& error, UtcTime next_at);

  // Increases when messages are added.
  [[nodiscard]] std::uint64_t generation() const { return generation_.load(); }
  struct Counters {
    std::uint64_t waiting = 0;
    std::uint64_t sent = 0, failed = 0;  // since the start; failed: attempts
    std::uint64_t lost = 0;              // dropped or expired
  };
  [[nodiscard]] Counters counters() const;

 private:
  struct Sent {
    std::string id;
    UtcTime at;
  };
  // Returns false, and closes the connection, if the store fails.
  bool attempt(const std::function<void(NotificationTable&)>& action);
  void count_lost(std::uint64_t count, const char* reason);

  const StoreAddress address_;
  const std::uint64_t most_;
  const Duration keep_;
  std::mutex mutex_;
  std::unique_ptr<SqlConnection> connection_;
  std::vector<Sent> unsaved_;
  std::string logged_;  // the last failure; each is logged once
  std::atomic<std::uint64_t> generation_{0}, waiting_{0}, sent_{0}, failed_{0}, lost_{0};
};

}  // namespace fieldcast::web
