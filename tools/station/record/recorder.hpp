// Records what the bridges of a domain publish into one store: samples, states of devices and
// alarms. It is told of everything that DDS brings, and hands it to the store's queue, which never
// waits for the database.
//
// A channel keeps its history when its bridge restarts or another one takes over. The last value,
// which DDS gives again to whoever comes late, is recorded once.
//
// Any thread, also several. The store must outlive it. Nothing can fail: what the store cannot take
// is counted there.
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
  // Channels that are known at a time; samples of others are counted as unknown.
  static constexpr std::size_t kMaxChannels = 200'000;
  static constexpr std::size_t kMaxDevices = 50'000;

  explicit Recorder(Store& store) : store_(store) {}
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  void on_channel(const StationChannel& channel);
  void on_gone(const std::string& bus, const std::string& device, const std::string& channel);
  // `received`: by this machine's clock.
  void on_sample(const StationSample& sample, UtcTime received);
  void on_device_status(const StationDeviceStatus& status);
  void on_alarm_status(const StationAlarmStatus& status, UtcTime received);

  struct Counters {
    std::uint64_t recorded = 0;  // samples that were handed to the store
    std::uint64_t repeated = 0;  // came once more
    std::uint64_t unknown = 0;   // their channel came to a full table
    std::size_t channels = 0;    // that are recorded
  };
  [[nodiscard]] Counters counters() const;

 private:
  struct Channel {
    std::optional<std::int64_t> number;  // the store's; nothing: no pattern names it
    bool told = false;                   // its unit and type are known
    bool gone = false;
    bool is_new = true;  // nothing came since the start, or since it came back
    SampleStamp stamp;
  };
  // With mutex_ held. Null: the table is full.
  [[nodiscard]] Channel* channel(std::string path);

  Store& store_;
  mutable std::mutex mutex_;
  std::unordered_map<std::string, Channel> channels_;        // by path
  std::map<std::string, ClockOffset, std::less<>> clocks_;   // by bus
  std::map<std::string, DeviceState, std::less<>> devices_;  // by bus/device: as stored last
  AlarmDiff alarms_;
  Counters counters_;
};

}  // namespace fieldcast::web
