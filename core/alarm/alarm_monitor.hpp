// The limits of all channels of one bus: samples in, changes of alarms out. Pure; one owner.
#pragma once

#include <span>
#include <vector>

#include "core/alarm/limit_watch.hpp"
#include "core/model/sample.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

struct AlarmChange {
  ChannelIndex channel = 0;
  LimitKind limit = LimitKind::kHigh;
  AlarmState state = AlarmState::kClear;
  double value = 0;  // the value that raised or cleared it
  Instant since{};   // when that value, or the first one beyond the limit, was acquired
};

class AlarmMonitor {
 public:
  explicit AlarmMonitor(const BusSpec& bus);

  // Appends what changed. Channels out of range are a bug.
  void on_samples(std::span<const Sample> samples, Instant now, std::vector<AlarmChange>& changes);
  // An alarm that was active before this monitor began. Appends the change if it has ended, or if
  // it goes on; nothing when the channel has no such limit.
  void restore(const AlarmChange& active, std::vector<AlarmChange>& changes);
  // Delays end with time too: call this once a second.
  void on_time(Instant now, std::vector<AlarmChange>& changes);

 private:
  struct Channel {
    ChannelIndex index;
    std::vector<LimitWatch> limits;
  };
  static AlarmChange change_of(const Channel& channel, const LimitWatch& limit);

  std::vector<Channel> channels_;  // those with limits
  // By channel index: its index in channels_ + 1, or 0 for a channel without limits.
  std::vector<std::uint32_t> watched_;
};

}  // namespace fieldcast
