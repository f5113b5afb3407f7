#include "core/alarm/alarm_monitor.hpp"

namespace fieldcast {
namespace {

std::vector<LimitWatch> watches_of(const Limits& limits) {
  std::vector<LimitWatch> watches;
  const std::pair<LimitKind, std::optional<double>> all[] = {
      {LimitKind::kLowLow, limits.low_low},
      {LimitKind::kLow, limits.low},
      {LimitKind::kHigh, limits.high},
      {LimitKind::kHighHigh, limits.high_high}};
  for (const auto& [kind, limit] : all) {
    if (limit) watches.emplace_back(kind, *limit, limits.hysteresis, limits.delay);
  }
  return watches;
}

}  // namespace

AlarmMonitor::AlarmMonitor(const BusSpec& bus) {
  ChannelIndex index = 0;
  for (const DeviceSpec& device : bus.devices) {
    for (const ChannelSpec& channel : device.channels) {
      auto limits = watches_of(channel.limits);
      if (!limits.empty()) channels_.push_back({index, std::move(limits)});
      watched_.push_back(channels_.empty() || channels_.back().index != index
                             ? 0
                             : static_cast<std::uint32_t>(channels_.size()));
      ++index;
    }
  }
}

void AlarmMonitor::on_samples(std::span<const Sample> samples, Instant now,
                              std::vector<AlarmChange>& changes) {
  if (channels_.empty()) return;
  for (const Sample& sample : samples) {
    const std::uint32_t watched = watched_.at(sample.channel);
    if (watched == 0) continue;
    Channel& channel = channels_[watched - 1];
    const auto number = as_number(sample.value);
    for (LimitWatch& limit : channel.limits) {
      if (sample.quality != Quality::kGood || !number) {
        limit.on_bad();
      } else if (limit.on_good(*number, sample.acquired, now)) {
        changes.push_back(change_of(channel, limit));
      }
    }
  }
}

void AlarmMonitor::restore(const AlarmChange& active, std::vector<AlarmChange>& changes) {
  const std::uint32_t watched = watched_.at(active.channel);
  if (watched == 0) return;
  Channel& channel = channels_[watched - 1];
  for (LimitWatch& limit : channel.limits) {
    if (limit.kind() != active.limit) continue;
    limit.restore(active.value, active.since);
    changes.push_back(change_of(channel, limit));
  }
}

void AlarmMonitor::on_time(Instant now, std::vector<AlarmChange>& changes) {
  for (Channel& channel : channels_) {
    for (LimitWatch& limit : channel.limits) {
      if (limit.on_time(now)) changes.push_back(change_of(channel, limit));
    }
  }
}

AlarmChange AlarmMonitor::change_of(const Channel& channel, const LimitWatch& limit) {
  return {channel.index, limit.kind(), limit.state(), limit.value(), limit.since()};
}

}  // namespace fieldcast
