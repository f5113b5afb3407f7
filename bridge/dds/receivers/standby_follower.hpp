// State of the buses that the master serves, as a waiting member collects it from the topics of
// stations: last samples, device reports, alarms, and which commands have a result. Owns its
// readers. Created and closed like endpoints of the link. Any thread may call take().
#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "bridge/dds/receivers/taker.hpp"
#include "bridge/dds/topics/topic_values.hpp"
#include "bridge/dds/transport/domain.hpp"
#include "bridge/standby/standby_values.hpp"
#include "core/base/time.hpp"
#include "core/model/bus_spec.hpp"
#include "idl/topics.h"

namespace fieldcast {

struct FollowerHandlers {
  // A command has its result. Called on a DDS thread.
  std::function<void(const std::string& requester, std::uint64_t request_id)> completed;
};

class StandbyFollower {
 public:
  // Throws DdsError.
  StandbyFollower(Domain& domain, const std::vector<BusSpec>& buses, FollowerHandlers handlers);
  ~StandbyFollower();
  StandbyFollower(const StandbyFollower&) = delete;
  StandbyFollower& operator=(const StandbyFollower&) = delete;

  [[nodiscard]] std::vector<StandbyBusFigures> figures() const;
  // Waits until everything up to these blocks has arrived. Returns false after the limit.
  [[nodiscard]] bool wait_for(const std::vector<StandbyBusFigures>& blocks, Duration limit) const;
  // Returns the current state, with instants on this machine's clock.
  [[nodiscard]] std::map<std::string, FollowedBus> take(const UtcMapping& now) const;
  [[nodiscard]] std::vector<StationAlarmStatus> alarms() const;
  void close();

 private:
  struct Bus {
    std::uint64_t epoch = 0, blocks = 0;
    std::vector<StationSample> samples;  // by channel, without names
    std::map<std::string, DeviceReport> devices;
  };
  void on_block(const idl::SampleBlock& block);
  void on_device(const idl::DeviceStatus& status);
  void on_alarm(const idl::AlarmStatus& status);

  Domain& domain_;
  mutable std::mutex mutex_;
  mutable std::condition_variable news_;
  std::map<std::string, Bus, std::less<>> buses_;
  std::map<AlarmKey, AlarmStatus> alarms_;
  Taker<idl::SampleBlock> blocks_;
  Taker<idl::DeviceStatus> devices_;
  Taker<idl::AlarmStatus> alarm_taker_;
  Taker<idl::CommandResult> results_;
  std::vector<dds::DataReader*> readers_;
};

}  // namespace fieldcast
