// Checks the limits of all channels of one bus. Pure; one owner.
#pragma once

#include <span>
#include <vector>

#include "core/alarm/alarm_status.hpp"
#include "core/model/bus_spec.hpp"
#include "core/model/sample.hpp"

namespace fieldcast {

struct AlarmChange {
  ChannelIndex channel = 0;
  LimitKind limit = LimitKind::kHigh;
  AlarmState state = AlarmState::kClear;
  double value = 0;  // value that raised or cleared it
  Instant since{};   // acquisition time of that value, or of the first one beyond the limit
};

class AlarmMonitor {
 public:
  explicit AlarmMonitor(const BusSpec& bus);

  [[nodiscard]] bool has_limits(ChannelIndex channel) const { return watched_.at(channel) != 0; }
  // REQUIRES: valid channel indices.
  void on_samples(std::span<const Sample> samples, Instant now, std::vector<AlarmChange>& changes);
  // Continues an active alarm: appends the change, if the channel has such a limit.
  void restore(const AlarmChange& active, std::vector<AlarmChange>& changes);
  // Call once a second, as delays end by time.
  void on_time(Instant now, std::vector<AlarmChange>& changes);

 private:
  struct Channel {
    ChannelIndex index;
    std::vector<LimitWatch> limits;
  };
  static AlarmChange change_of(const Channel& channel, const LimitWatch& limit);

  std::vector<Channel> channels_;  // those with limits
  // By channel index: index in channels_ + 1, or 0 for a channel without limits.
  std::vector<std::uint32_t> watched_;
};

}  // namespace fieldcast
