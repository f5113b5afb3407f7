// Chooses the publication time of a sample, which DDS does not transmit. A good sample uses its
// acquisition time, so that a second or restarted recorder writes the same row. Other samples are
// published later; they use the arrival time by the bridge's clock. Pure; cannot fail.
#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "bridge/dds/topics/topic_values.hpp"
#include "bridge/store/records/records.hpp"
#include "bridge/store/store.hpp"
#include "core/alarm/alarm_registry.hpp"
#include "tools/backfill/gap.hpp"

namespace fieldcast::web {

// Difference between arrival and acquisition of samples of a bus: delay plus clock difference. It
// can be negative.
class ClockOffset {
 public:
  static constexpr Duration kWindow = std::chrono::minutes{1};

  // Adds a good sample; ignores a difference of more than SampleStamp::kMaxOffset.
  void note(UtcTime acquired, UtcTime received);
  [[nodiscard]] Duration least() const;  // minimum of the last one or two windows; 0: no sample

 private:
  std::optional<Duration> before_, now_;
  UtcTime window_began_;
};

class SampleStamp {
 public:
  // Beyond this difference the clock of the bridge is wrong, and the arrival time is used.
  static constexpr Duration kMaxOffset = std::chrono::minutes{10};
  // Maximum age of the first sample, which may be the last value of a slow channel.
  static constexpr Duration kOldest = std::chrono::hours{24};
  // Within this time, samples keep the order of their arrival.
  static constexpr Duration kOrder = std::chrono::seconds{2};

  // Empty for a duplicate. `first`: first sample since the channel exists.
  [[nodiscard]] std::optional<UtcTime> next(const StationSample& sample, UtcTime received,
                                            Duration offset, bool first);

 private:
  bool any_ = false;
  std::uint64_t sequence_ = 0;
  UtcTime acquired_;
  UtcTime published_;
  Quality quality_ = Quality::kNotYetRead;
};

// The first sample of a channel since the start.
struct FirstSample {
  std::string path;
  SampleNumber number;
  UtcTime published_at;  // as it is stored
};

struct AlarmNews {
  std::vector<AlarmRecord> records;  // raised, cleared
  std::vector<AlarmEvent> events;
  std::vector<KeptAlarm> kept;
  std::vector<KeptMaintenance> maintenance;
};

// Derives alarm events for the store from successive statuses, because DDS publishes only these.
// Events use the times in the status, so a second recorder writes equal records. Pure; cannot fail.
class AlarmDiff {
 public:
  static constexpr std::size_t kMaxAlarms = 50'000;  // further alarms are ignored

  // `received`: local time, for events without a time of their own.
  [[nodiscard]] AlarmNews next(const StationAlarmStatus& alarm, UtcTime received);

 private:
  void compare(const AlarmKey& key, const AlarmStatus& before, const AlarmStatus& now,
               UtcTime received, AlarmNews& news);
  void compare_shelving(const AlarmKey& key, const AlarmPause& before, const AlarmPause& now,
                        UtcTime received, AlarmNews& news);
  // All alarms of a device report its maintenance; it is recorded once.
  void compare_maintenance(const AlarmKey& key, const AlarmPause& now, UtcTime received,
                           AlarmNews& news);

  std::map<AlarmKey, AlarmStatus> known_;
  std::map<AlarmDevice, AlarmPause> maintenance_;
};

// Records samples, device states and alarms of a domain in one store, by its queue, which never
// waits for the database. The history continues when a bridge restarts or another takes over; the
// last value, which DDS sends again, is recorded once. Thread-safe; cannot fail. The store must
// outlive it.
class Recorder {
 public:
  // The response time of each device is stored once a minute as a channel of this name, which no
  // configured channel can have. Its unit is ms; a device that is offline has no value.
  static constexpr const char* kResponseTime = "$response-time";
  // Further channels are ignored; their samples count as unknown.
  static constexpr std::size_t kMaxChannels = 200'000;
  static constexpr std::size_t kMaxDevices = 50'000;
  // Gaps that were not taken yet. Further ones stay in the record.
  static constexpr std::size_t kMaxGaps = 2 * kMaxChannels;
  static constexpr std::size_t kMaxWaiting = Store::kMaxWaiting / 10;  // samples; is_busy()

  explicit Recorder(Store& store) : store_(store) {}
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  void on_channel(const StationChannel& channel);
  void on_gone(const std::string& bus, const std::string& device, const std::string& channel);
  void on_sample(const StationSample& sample, UtcTime received);
  void on_device_status(const StationDeviceStatus& status, UtcTime received);
  void on_alarm_status(const StationAlarmStatus& status, UtcTime received);

  // From now on, samples that are missing between two others are noted.
  void watch_gaps();
  struct Gaps {
    std::vector<Gap> gaps;
    std::vector<FirstSample> first;  // samples before them may be missing
  };
  [[nodiscard]] Gaps take_gaps();
  // A missing sample that was fetched from the store of a bridge.
  void on_fetched(const std::string& path, const HistoryRow& row);
  // True while the store has many samples to write.
  [[nodiscard]] bool is_busy() const { return store_.counters().waiting > kMaxWaiting; }

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
    SampleNumber last;   // of the last sample; epoch 0: none
    SampleStamp stamp;
  };
  struct Device {
    DeviceState state = DeviceState::kUnknown;  // last stored one
    std::optional<std::int64_t> number;  // of its response time in the store; empty: not stored
    std::int64_t minute = 0;             // of the last stored response time
  };
  // Stores the response time, at most once a minute. REQUIRES: mutex_ is held.
  void put_response_time(const StationDeviceStatus& status, UtcTime received, Device& device);
  // Returns null if the table is full. REQUIRES: mutex_ is held.
  [[nodiscard]] Channel* channel(std::string path);
  // Notes a gap between the last sample and this one.
  void note(Channel& channel, const StationSample& sample, UtcTime published);

  Store& store_;
  mutable std::mutex mutex_;
  std::unordered_map<std::string, Channel> channels_;       // by path
  std::map<std::string, ClockOffset, std::less<>> clocks_;  // by bus
  std::map<std::string, Device, std::less<>> devices_;      // by bus/device
  AlarmDiff alarms_;
  bool watches_gaps_ = false;
  Gaps gaps_;
  Counters counters_;
};

}  // namespace fieldcast::web
