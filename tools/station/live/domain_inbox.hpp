// Passes messages from DDS threads to the io thread. Keeps only the newest of each channel and
// object, so memory is bounded. on_..() is thread-safe; deliver() runs on the io thread. Wake is
// called once for the first waiting message, and again after deliver().
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <variant>

#include "tools/station/model/live_model.hpp"

namespace fieldcast::web {

class DomainInbox {
 public:
  // Further objects are dropped and counted.
  static constexpr std::size_t kMaxObjects = 100'000;
  // Called on the DDS thread without a lock; must only post.
  using Wake = std::function<void()>;

  explicit DomainInbox(Wake wake) : wake_(std::move(wake)) {}

  void on_channel(const StationChannel& channel);
  void on_sample(const StationSample& sample);
  void on_gone(const std::string& bus, const std::string& device, const std::string& channel);
  void on_bus_status(const StationBusStatus& status);
  void on_bus_gone(const StationBusStatus& last);
  void on_device_status(const StationDeviceStatus& status);
  void on_device_gone(const StationDeviceStatus& last);
  void on_alarm(const StationAlarm& alarm);
  void on_alarm_gone(const StationAlarm& last);
  void on_alarm_status(const StationAlarmStatus& status);
  void on_alarm_status_gone(const StationAlarmStatus& last);
  void on_session(const ProgramSessionReport& session);
  void on_bridge(const StationBridge& bridge);
  void on_bridge_gone(const StationBridge& last);
  void on_read_plan(const StationReadPlan& plan);
  void on_read_plan_gone(const std::string& bus);

  void deliver(LiveModel& model, Instant now);

  struct Counters {
    std::uint64_t samples = 0;    // received
    std::uint64_t overtaken = 0;  // replaced by a newer sample of the channel while waiting
    std::uint64_t dropped = 0;    // objects and channels beyond the limit
    std::uint64_t deliveries = 0;
  };
  [[nodiscard]] Counters counters() const;  // thread-safe

 private:
  // News of one channel, applied in this order: removed, announced, value.
  struct PathNews {
    ChannelPath path;
    bool gone = false;
    std::unique_ptr<StationChannel> channel;
    bool has_value = false;
    LiveValue value;
  };
  using Object = std::variant<StationBusStatus, StationDeviceStatus, LiveAlarm,
                              ProgramSessionReport, StationBridge, StationReadPlan>;
  struct ObjectNews {
    Object object;
    bool gone = false;
  };
  struct Batch {
    std::deque<PathNews> paths;
    std::unordered_map<PathView, PathNews*, PathHash, PathEqual> by_path;
    std::map<std::string, ObjectNews> objects;
  };
  // Returns null if the inbox is full. REQUIRES: mutex_ is held.
  PathNews* news_of(const PathView& path);
  void put(std::string key, Object object, bool gone);
  // Calls wake_ if it was not called since the last delivery. REQUIRES: mutex_ is not held.
  void wake(bool first);
  [[nodiscard]] bool mark();  // REQUIRES: mutex_ is held

  const Wake wake_;
  mutable std::mutex mutex_;
  Batch batch_;
  bool woken_ = false;
  Counters counters_;
};

}  // namespace fieldcast::web
