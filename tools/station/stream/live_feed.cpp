#include "tools/station/stream/live_feed.hpp"

#include <set>
#include <string_view>

namespace fieldcast::web {

void LiveFeed::announce(const SharedCatalogue& before, const SharedCatalogue& now) {
  std::set<std::string_view> present;
  for (const StationChannel& channel : now->channels) {
    present.insert(channel.channel);
    inbox_.on_channel(channel, Origin::kStream);
  }
  if (before == nullptr) return;
  for (const StationChannel& channel : before->channels) {
    if (!present.contains(channel.channel))
      inbox_.on_gone(channel.bus, channel.device, channel.channel);
  }
}

void LiveFeed::pass(const StreamBatch& batch, UtcTime now) {
  if (batch.is_late) return;
  const std::string name = batch.samples.bus + '/' + batch.samples.device;
  if (!devices_.contains(name) && devices_.size() >= kMaxDevices) return;
  SharedCatalogue& known = devices_[name];
  // The cache may have read an equal catalogue again.
  if (known == nullptr || (known != batch.catalogue && *known != *batch.catalogue))
    announce(known, batch.catalogue);
  known = batch.catalogue;
  const bool is_old =
      saturated_difference(now.nanoseconds, batch.stored_at.nanoseconds) > Duration{kOld}.count();
  const std::vector<forward::BatchSample>& samples = batch.samples.samples;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const forward::BatchSample& sample = samples[i];
    if (i + 1 < samples.size() && samples[i + 1].channel == sample.channel) continue;
    const StationChannel& channel = known->channels[sample.channel];
    const bool is_uncertain = is_old && sample.quality == Quality::kGood;
    inbox_.on_value({channel.bus, channel.device, channel.channel},
                    {sample.value, is_uncertain ? Quality::kUncertain : sample.quality,
                     sample.device_code, sample.acquired_at, sample.sequence});
  }
}

}  // namespace fieldcast::web
