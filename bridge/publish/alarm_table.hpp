// The alarms of the bridge, beyond the life of the bus that raised them: a bus that starts anew
// goes on with them, and so does a bridge that has a store. Takes what people do about them. Says
// what the store is to keep: each beginning once, each end once, and every change besides.
//
// A lock around AlarmBook, and the way into the store. Any thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "bridge/store/alarm_sink.hpp"
#include "core/alarm/alarm_book.hpp"

namespace fieldcast {

class AlarmTable {
 public:
  static constexpr std::size_t kMaxHeld = 4096;  // until the store is open; more are not stored

  // A store is about to keep the alarms: what comes is held until it says what it knows, and people
  // cannot do anything yet.
  void expect_store();
  // How the last bridge left them. From now on the sink, which outlives its use, keeps them.
  void loaded(AlarmSink& sink, const KeptAlarms& kept);
  // How another bridge, which has served the bus meanwhile, has left its alarms in the same store.
  void loaded(const std::string& bus, const KeptAlarms& kept);
  // How another bridge of the standby group has left them, as it has published them.
  void followed(const std::string& bus, const KeptAlarms& kept);
  // The store is about to close; what is still held goes to it. Null: there was none.
  void close(AlarmSink* sink);

  // Called for each alarm whose status changed, or that is none any more: status_of() says which.
  // It must only post. Not called any more once publish_with({}) has returned.
  using Publish = std::function<void(const AlarmKey& alarm)>;
  void publish_with(Publish publish);
  // All that are known of a bus: DDS has begun to publish it.
  void publish_again(const std::string& bus);
  // Nothing: it is none.
  [[nodiscard]] std::optional<AlarmStatus> status_of(const AlarmKey& alarm) const;

  // The limits that are in force from now on: what was active at others of these buses, or of the
  // buses before, ends now. Those that ended come back, as clear.
  std::vector<AlarmRecord> configure(const std::vector<BusSpec>& buses, UtcTime now);

  // Raised or cleared.
  void note(const AlarmRecord& record);
  // What a person does.
  [[nodiscard]] AlarmOutcome act(const AlarmAction& action, UtcTime now);
  // What ends by itself at the alarms of the bus. Once a second.
  void on_time(const std::string& bus, UtcTime now);

  [[nodiscard]] AlarmCounts counts() const;

  // Grows when there may be alarms that a bus does not know yet. 0: never.
  [[nodiscard]] std::uint64_t version() const { return version_.load(std::memory_order_acquire); }
  [[nodiscard]] std::vector<AlarmRecord> active_of(const std::string& bus) const;

 private:
  // REQUIRES for those that follow: mutex_ held.
  void enter(const AlarmRecord& record, UtcTime now);
  std::vector<AlarmRecord> end(const std::vector<KeptAlarm>& ended, UtcTime now);
  // What changed, for publish(); the store has got its part.
  [[nodiscard]] std::set<AlarmKey> take_changes();

  void publish(const std::set<AlarmKey>& changed);  // without the lock

  mutable std::mutex mutex_;
  AlarmBook book_;
  std::vector<AlarmRecord> held_;
  AlarmSink* sink_ = nullptr;
  bool loading_ = false;
  std::atomic<std::uint64_t> version_{1};
  std::mutex publish_mutex_;  // never taken under mutex_
  Publish publish_;
};

}  // namespace fieldcast
