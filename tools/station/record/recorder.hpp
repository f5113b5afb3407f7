// Records samples, device states and alarms of a domain in one store, by its queue, which never
// waits for the database. The history continues when a bridge restarts or another takes over; the
// last value, which DDS sends again, is recorded once. Thread-safe; cannot fail. The store must
// outlive it.
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <unordered_map>

#include "bridge/store/store.hpp"
#include "tools/station/record/alarm_diff.hpp"
#include "tools/station/record/sample_stamp.hpp"

namespace fieldcast::web {

class Recorder {
 public:
  // Further channels are ignored; their samples count as unknown.
  static constexpr std::size_t kMaxChannels = 200'000;
  static constexpr std::size_t kMaxDevices = 50'000;

  explicit Recorder(Store& store) : store_(store) {}
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  void on_channel(const StationChannel& channel);
  void on_gone(const std::string& bus, const std::string& device, const std::string& channel);
  // `received`: local time.
  void on_sample(const StationSample& sample, UtcTime received);
  void on_device_status(const StationDeviceStatus& status);
  void on_alarm_status(const StationAlarmStatus& status, UtcTime received);

  struct Counters {
    std::uint64_t recorded = 0;  // samples passed to the store
    std::uint64_t repeated = 0;  // duplicates
    std::uint64_t unknown = 0;   // samples of channels beyond kMaxChannels
    std::size_t channels = 0;    // recorded channels
  };
  [[nodiscard]] Counters counters() const;

 private:
  struct Channel {
    std::optional<std::int64_t> number;  // number in the store; empty: matches no pattern
    bool told = false;                   // unit and type are known
    bool gone = false;
    bool is_new = true;  // no sample since start or since its return
    SampleStamp stamp;
  };
  // Returns null if the table is full. REQUIRES: mutex_ is held.
  [[nodiscard]] Channel* channel(std::string path);

  Store& store_;
  mutable std::mutex mutex_;
  std::unordered_map<std::string, Channel> channels_;        // by path
  std::map<std::string, ClockOffset, std::less<>> clocks_;   // by bus
  std::map<std::string, DeviceState, std::less<>> devices_;  // last stored state, by bus/device
  AlarmDiff alarms_;
  Counters counters_;
};

}  // namespace fieldcast::web
