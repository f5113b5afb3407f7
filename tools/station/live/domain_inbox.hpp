// What DDS threads hear of the domain, on its way to the io thread. The newest of each channel and
// of each object wins, so that what waits is bounded by what there is, however long the io thread
// takes.
//
// on_..() on any thread, which waits for nothing but a short lock; deliver() on the io thread. The
// owner of the thread is told once when something waits (Wake), and again after deliver().
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

#include "tools/station/live/live_model.hpp"
#include "tools/station/live/path_key.hpp"

namespace fieldcast::web {

class DomainInbox {
 public:
  // Objects that wait; what is beyond them is dropped and counted.
  static constexpr std::size_t kMaxObjects = 100'000;
  // Called on the thread that brings something, without a lock; it only posts.
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

  // Everything that waits, into the model.
  void deliver(LiveModel& model, Instant now);

  struct Counters {
    std::uint64_t samples = 0;    // that came
    std::uint64_t overtaken = 0;  // by a newer one of their channel while they waited
    std::uint64_t dropped = 0;    // objects and channels beyond the limit
    std::uint64_t deliveries = 0;
  };
  [[nodiscard]] Counters counters() const;  // any thread

 private:
  // Of one channel, in the order in which it counts: gone, then there, then a value.
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
  // REQUIRES: mutex_ held. Null: the inbox is full.
  PathNews* news_of(const PathView& path);
  void put(std::string key, Object object, bool gone);
  // Calls wake_ when it was not called since the last delivery. REQUIRES: mutex_ not held.
  void wake(bool first);
  [[nodiscard]] bool mark();  // REQUIRES: mutex_ held

  const Wake wake_;
  mutable std::mutex mutex_;
  Batch batch_;
  bool woken_ = false;
  Counters counters_;
};

}  // namespace fieldcast::web
