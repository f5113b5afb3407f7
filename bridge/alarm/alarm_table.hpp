// Alarms of the bridge: AlarmRegistry with a lock and a connection to the store. They outlive the
// bus that raised them: a restarted bus continues them, and with a store also a restarted bridge.
// Passes to the store each beginning once, each end once, and every other change. Any thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bridge/store/records/records.hpp"
#include "core/alarm/alarm_monitor.hpp"
#include "core/alarm/alarm_registry.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

class AlarmTable {
 public:
  static constexpr std::size_t kMaxHeld = 4096;  // until the store is open; more are not stored

  // A store will be connected: changes are held until loaded(), and actions of users are refused.
  void expect_store();
  // Loads the alarms of the previous run. `sink` stores later changes and must outlive that.
  void loaded(AlarmSink& sink, const KeptAlarms& kept);
  // Loads the alarms that another bridge has written to the same store meanwhile.
  void loaded(const std::string& bus, const KeptAlarms& kept);
  // Adopts the alarms that another bridge of the standby group has published.
  void followed(const std::string& bus, const KeptAlarms& kept);
  // The store is about to close and gets the changes that are still held. Null: there was none.
  void close(AlarmSink* sink);

  // Called for each alarm whose status changed or that was removed; status_of() returns the status.
  // An alarm that was not normal when its limit was removed has its end as the status.
  // Must only post. Not called after publish_with({}) has returned.
  using Publish = std::function<void(const AlarmKey& alarm)>;
  void publish_with(Publish publish);
  // Publishes all alarms of a bus again, when DDS has begun to publish the bus.
  void publish_again(const std::string& bus);
  [[nodiscard]] std::optional<AlarmStatus> status_of(const AlarmKey& alarm) const;

  // Sets the limits. Active alarms of removed limits end now and are returned as clear.
  std::vector<AlarmRecord> configure(const std::vector<BusSpec>& buses, UtcTime now);

  void note(const AlarmRecord& record);
  [[nodiscard]] AlarmOutcome act(const AlarmAction& action, UtcTime now);
  // Ends what ends by time at the alarms of the bus. Call once a second.
  void on_time(const std::string& bus, UtcTime now);

  [[nodiscard]] AlarmCounts counts() const;

  // Increases when there may be alarms that a bus has not restored yet. 0: never.
  [[nodiscard]] std::uint64_t version() const { return version_.load(std::memory_order_acquire); }
  [[nodiscard]] std::vector<AlarmRecord> active_of(const std::string& bus) const;

 private:
  // The next functions REQUIRE: mutex_ held.
  void enter(const AlarmRecord& record, UtcTime now);
  // Returns the records of those that were active.
  std::vector<AlarmRecord> end(std::vector<KeptAlarm> ended, UtcTime now);
  // Returns the changes for publish(), after passing them to the store.
  [[nodiscard]] std::set<AlarmKey> take_changes();

  void publish(const std::set<AlarmKey>& changed);  // without the lock

  mutable std::mutex mutex_;
  AlarmRegistry book_;
  std::map<AlarmKey, AlarmStatus> ended_;  // whose limit was removed before they were normal
  std::vector<AlarmRecord> held_;
  AlarmSink* sink_ = nullptr;
  bool loading_ = false;
  std::atomic<std::uint64_t> version_{1};
  std::mutex publish_mutex_;  // never locked while mutex_ is held
  Publish publish_;
};

// Alarms of one bus: compares the samples with the limits, updates the table of active alarms,
// writes the log, and returns each change for DDS. Called on the bus's thread.
class AlarmReporter {
 public:
  // The table outlives this object.
  AlarmReporter(AlarmTable& table, const BusSpec& bus);

  // Return the changes, usually none, including alarms from before the start of this bus.
  [[nodiscard]] std::vector<AlarmChange> on_samples(const std::vector<Sample>& samples,
                                                    const UtcMapping& mapping, Instant now);
  [[nodiscard]] std::vector<AlarmChange> on_time(const UtcMapping& now);  // once a second

 private:
  enum class Origin : std::uint8_t { kNew, kRestored };
  [[nodiscard]] std::vector<AlarmChange> restore();  // empty unless the table has changed
  void note(const std::vector<AlarmChange>& changes, const UtcMapping& mapping, Origin origin);

  AlarmTable& table_;
  AlarmMonitor monitor_;
  const std::string bus_;
  // Device and channel of those with limits.
  std::map<ChannelIndex, std::pair<std::string, std::string>> names_;
  std::uint64_t restored_ = 0;
};

}  // namespace fieldcast
