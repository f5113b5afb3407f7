#include "bridge/dds/receivers/standby_follower.hpp"

#include <algorithm>

#include "bridge/dds/topics/block.hpp"
#include "bridge/dds/topics/conversion.hpp"
#include "bridge/dds/topics/sample_type.hpp"

namespace fieldcast {

StandbyFollower::StandbyFollower(Domain& domain, const std::vector<BusSpec>& buses,
                                 FollowerHandlers handlers)
    : domain_(domain),
      blocks_([this](const idl::SampleBlock& block, const dds::SampleInfo&) { on_block(block); }),
      devices_(
          [this](const idl::DeviceStatus& status, const dds::SampleInfo&) { on_device(status); }),
      alarm_taker_(
          [this](const idl::AlarmStatus& status, const dds::SampleInfo&) { on_alarm(status); }),
      results_([completed = std::move(handlers.completed)](const idl::CommandResult& result,
                                                           const dds::SampleInfo&) {
        completed(result.requester().c_str(), result.request_id());
      }) {
  for (const BusSpec& spec : buses) {
    std::size_t channels = 0;
    for (const DeviceSpec& device : spec.devices) channels += device.channels.size();
    buses_[spec.name].samples.resize(channels);
  }
  const auto data = dds::StatusMask::data_available();
  readers_.push_back(domain.reader(kSampleBlockTopic, &blocks_, data));
  readers_.push_back(domain.reader(kDeviceStatusTopic, &devices_, data));
  readers_.push_back(domain.reader(kAlarmStatusTopic, &alarm_taker_, data));
  readers_.push_back(domain.reader(kCommandResultTopic, &results_, data));
}

StandbyFollower::~StandbyFollower() { close(); }

void StandbyFollower::close() {
  for (dds::DataReader* reader : readers_) domain_.remove(reader);
  readers_.clear();
}

// Ignores blocks of an earlier epoch: they are from a master that was replaced.
void StandbyFollower::on_block(const idl::SampleBlock& block) {
  if (!is_whole(block)) return;
  const std::lock_guard lock(mutex_);
  const auto found = buses_.find(std::string_view(block.bus().c_str()));
  if (found == buses_.end() || block.epoch() < found->second.epoch) return;
  Bus& bus = found->second;
  if (block.epoch() > bus.epoch) {
    bus.epoch = block.epoch();
    bus.blocks = 0;
    for (StationSample& sample : bus.samples) sample.sequence = 0;
  }
  bus.blocks = std::max(bus.blocks, block.number());
  for (std::size_t row = 0; row < block.channels().size(); ++row) {
    const std::uint32_t channel = block.channels()[row];
    if (channel >= bus.samples.size()) continue;
    if (block.sequences()[row] <= bus.samples[channel].sequence) continue;
    (void)read_row(block, row, bus.samples[channel]);
  }
  news_.notify_all();
}

void StandbyFollower::on_device(const idl::DeviceStatus& status) {
  StationDeviceStatus known = from_idl(status);
  const std::lock_guard lock(mutex_);
  const auto found = buses_.find(known.bus);
  if (found == buses_.end()) return;
  found->second.devices[known.device] = std::move(known.report);
}

void StandbyFollower::on_alarm(const idl::AlarmStatus& status) {
  const auto known = from_idl(status);
  if (!known) return;
  const std::lock_guard lock(mutex_);
  if (buses_.contains(known->alarm.bus)) alarms_[known->alarm] = known->status;
}

std::vector<StandbyBusFigures> StandbyFollower::figures() const {
  const std::lock_guard lock(mutex_);
  std::vector<StandbyBusFigures> figures;
  for (const auto& [name, bus] : buses_) figures.push_back({name, bus.epoch, bus.blocks});
  return figures;
}

bool StandbyFollower::wait_for(const std::vector<StandbyBusFigures>& blocks, Duration limit) const {
  std::unique_lock lock(mutex_);
  return news_.wait_for(lock, limit, [&] {
    return std::ranges::all_of(blocks, [&](const StandbyBusFigures& wanted) {
      const auto found = buses_.find(wanted.bus);
      return found == buses_.end() ||
             (found->second.epoch == wanted.epoch && found->second.blocks >= wanted.blocks);
    });
  });
}

std::map<std::string, FollowedBus> StandbyFollower::take(const UtcMapping& now) const {
  const std::lock_guard lock(mutex_);
  std::map<std::string, FollowedBus> all;
  // The clock of the master may be ahead. The next readings must have later times than the samples.
  const auto acquired = [&](UtcTime at) {
    return at.nanoseconds == 0 ? kLongAgo : std::min(now.to_instant(at), now.instant);
  };
  for (const auto& [name, bus] : buses_) {
    FollowedBus& followed = all[name];
    followed.epoch = bus.epoch;
    followed.blocks = bus.blocks;
    followed.state.devices = bus.devices;
    ChannelIndex channel = 0;
    for (const StationSample& sample : bus.samples) {
      followed.state.samples.push_back({channel++, sample.value, sample.quality, sample.device_code,
                                        acquired(sample.acquired_at), sample.sequence});
    }
  }
  return all;
}

std::vector<StationAlarmStatus> StandbyFollower::alarms() const {
  const std::lock_guard lock(mutex_);
  std::vector<StationAlarmStatus> all;
  for (const auto& [key, status] : alarms_) all.push_back({key, status});
  return all;
}

}  // namespace fieldcast
