// Alarms of the bridge. They outlive the bus that raised them: a restarted bus continues them, and
// with a store also a restarted bridge does. Applies the actions of users. Passes to the store each
// beginning once, each end once, and every other change.
//
// AlarmRegistry with a lock and a connection to the store. Any thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "bridge/store/records/alarm_sink.hpp"
#include "core/alarm/alarm_registry.hpp"

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
  std::vector<AlarmRecord> end(const std::vector<KeptAlarm>& ended, UtcTime now);
  // Returns the changes for publish(), after passing them to the store.
  [[nodiscard]] std::set<AlarmKey> take_changes();

  void publish(const std::set<AlarmKey>& changed);  // without the lock

  mutable std::mutex mutex_;
  AlarmRegistry book_;
  std::vector<AlarmRecord> held_;
  AlarmSink* sink_ = nullptr;
  bool loading_ = false;
  std::atomic<std::uint64_t> version_{1};
  std::mutex publish_mutex_;  // never locked while mutex_ is held
  Publish publish_;
};

}  // namespace fieldcast
