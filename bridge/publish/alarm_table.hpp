// The alarms that are active, beyond the life of the bus that raised them: a bus that starts anew
// goes on with them, and so does a bridge that has a store. Says what the store is to keep: each
// beginning once, each end once. Any thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "bridge/store/alarm_sink.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

class AlarmTable {
 public:
  static constexpr std::size_t kMaxHeld = 4096;  // until the store is open; more are not stored

  // A store is about to keep the alarms: what comes is held until it says what it knows.
  void expect_store();
  // What was active when the last bridge ended. From now on the sink, which outlives its use, keeps
  // what begins and ends.
  void loaded(AlarmSink& sink, const std::vector<AlarmRecord>& active);
  // The store is about to close; what is still held goes to it. Null: there was none.
  void close(AlarmSink* sink);

  // The limits that are in force from now on: what was active at others of these buses, or of the
  // buses before, ends now. Those that ended come back, as clear.
  std::vector<AlarmRecord> configure(const std::vector<BusSpec>& buses, UtcTime now);

  // Raised or cleared.
  void note(const AlarmRecord& record);

  // Grows when there may be alarms that a bus does not know yet. 0: never.
  [[nodiscard]] std::uint64_t version() const { return version_.load(std::memory_order_acquire); }
  [[nodiscard]] std::vector<AlarmRecord> active_of(const std::string& bus) const;

 private:
  using Key = std::tuple<std::string, std::string, std::string, std::string>;
  static Key key_of(const AlarmRecord& record);
  void keep(const AlarmRecord& record);
  std::vector<AlarmRecord> end_others(UtcTime now);

  mutable std::mutex mutex_;
  std::map<Key, AlarmRecord> active_;
  std::set<Key> limits_;         // in force
  std::set<std::string> buses_;  // of this bridge, now or before
  std::vector<AlarmRecord> held_;
  AlarmSink* sink_ = nullptr;
  bool loading_ = false;
  std::atomic<std::uint64_t> version_{1};
};

}  // namespace fieldcast
