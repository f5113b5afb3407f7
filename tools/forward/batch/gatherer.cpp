#include "tools/forward/batch/gatherer.hpp"

#include <algorithm>
#include <utility>

namespace fieldcast::forward {

Gatherer::Device* Gatherer::device_of(const std::string& bus, const std::string& device) {
  if (last_ != nullptr && last_->pending.device == device && last_->pending.bus == bus)
    return last_;
  const auto found = devices_.find(bus + '/' + device);
  if (found == devices_.end()) return nullptr;
  last_ = &found->second;
  return last_;
}

std::optional<std::uint32_t> Gatherer::Device::find(const std::string& channel) const {
  const auto found = index.find(channel);
  return found == index.end() ? std::nullopt : std::optional(found->second);
}

void Gatherer::on_channel(const StationChannel& channel) {
  Device& device = devices_[channel.bus + '/' + channel.device];
  device.pending.bus = channel.bus;
  device.pending.device = channel.device;
  if (const auto known = device.find(channel.channel)) {
    Channel& entry = device.channels[*known];
    entry.removed = false;
    if (entry.entry == channel) return;
    entry.entry = channel;
    device.is_published = false;
    return;
  }
  std::string path = channel.path();
  if (positions_.size() >= kMaxChannels && !positions_.contains(path)) return;
  device.index.emplace(channel.channel, static_cast<std::uint32_t>(device.channels.size()));
  Position* position = &positions_[path];
  device.channels.push_back({channel, std::move(path), position});
  device.is_published = false;
}

void Gatherer::on_channel_removed(const std::string& bus, const std::string& device,
                                  const std::string& channel) {
  const auto found = devices_.find(bus + '/' + device);
  if (found == devices_.end()) return;
  Device& from = found->second;
  const auto known = from.find(channel);
  if (!known) return;
  from.channels[*known].removed = true;
  if (!std::ranges::all_of(from.channels, &Channel::removed)) return;
  end_batch(from);
  last_ = nullptr;
  devices_.erase(found);
}

void Gatherer::on_sample(const StationSample& sample, Instant now) {
  Device* const device = device_of(sample.bus, sample.device);
  const std::optional<std::uint32_t> channel =
      device == nullptr ? std::nullopt : device->find(sample.channel);
  if (!channel) {
    ++counters_.unknown;
    return;
  }
  Position& position = *device->channels[*channel].position;
  if (position.epoch == sample.epoch && sample.sequence <= position.sequence) {
    ++counters_.repeated;
    return;
  }
  if (pending_ >= kMaxPending) {
    ++counters_.refused;
    return;
  }
  SampleBatch& batch = device->pending;
  if (batch.epoch != sample.epoch) end_batch(*device);
  if (batch.samples.empty()) {
    device->began = now;
    batch.epoch = sample.epoch;
  }
  const Position present{sample.epoch, sample.sequence};
  if (is_gap(number_of(position), number_of(present)))
    device->gaps.push_back(
        {device->channels[*channel].path, number_of(position), number_of(present), {}});
  position = present;
  batch.samples.push_back({*channel, sample.sequence, sample.acquired_at, sample.value,
                           sample.quality, sample.device_code});
  ++pending_;
  ++counters_.accepted;
  if (const auto* text = std::get_if<std::string>(&sample.value)) device->texts += text->size();
  if (batch.samples.size() >= spec_.samples || device->texts >= kMaxTexts) end_batch(*device);
}

Gathered Gatherer::gathered(Device& device, SampleBatch batch) const {
  Gathered gathered;
  if (!device.is_published) {
    DeviceCatalogue& catalogue = gathered.catalogue.emplace();
    catalogue.bus = batch.bus;
    catalogue.device = batch.device;
    for (const Channel& channel : device.channels) catalogue.channels.push_back(channel.entry);
    device.catalogue = identity_of(catalogue);
    device.is_published = true;
  }
  batch.catalogue = device.catalogue;
  std::stable_sort(
      batch.samples.begin(), batch.samples.end(),
      [](const BatchSample& a, const BatchSample& b) { return a.channel < b.channel; });
  gathered.batch = std::move(batch);
  return gathered;
}

void Gatherer::end_batch(Device& device) {
  if (device.pending.samples.empty()) return;
  SampleBatch ended{device.pending.bus, device.pending.device, device.pending.epoch, 0,
                    std::exchange(device.pending.samples, {})};
  Gathered gathered = this->gathered(device, std::move(ended));
  const SampleBatch& batch = gathered.batch;
  for (std::size_t i = 0; i < batch.samples.size(); ++i) {
    const BatchSample& sample = batch.samples[i];
    if (i + 1 < batch.samples.size() && batch.samples[i + 1].channel == sample.channel) continue;
    gathered.positions.push_back(
        {device.channels[sample.channel].path, {batch.epoch, sample.sequence}});
  }
  gathered.gaps = std::exchange(device.gaps, {});
  device.texts = 0;
  ended_.push_back(std::move(gathered));
}

bool Gatherer::has_bus(const std::string& bus) const {
  const auto first = devices_.lower_bound(bus + '/');
  return first != devices_.end() && first->first.starts_with(bus + '/');
}

void Gatherer::on_fetched(Fetched fetched) {
  Device* const of = device_of(fetched.bus, fetched.device);
  if (of == nullptr) return;
  SampleBatch batch{fetched.bus, fetched.device, fetched.epoch, 0, {}};
  for (auto& [name, row] : fetched.samples) {
    const auto channel = of->find(name);
    if (!channel) continue;
    batch.samples.push_back({*channel, row.number.sequence, row.acquired_at, std::move(row.value),
                             row.quality, row.device_code});
  }
  if (batch.samples.empty()) return;
  pending_ += batch.samples.size();
  ended_.push_back(gathered(*of, std::move(batch)));
  ended_.back().is_late = true;
}

std::vector<Gathered> Gatherer::take(Instant now, bool all) {
  for (auto& [name, device] : devices_) {
    if (all || now - device.began >= spec_.time) end_batch(device);
  }
  for (const Gathered& gathered : ended_) pending_ -= gathered.batch.samples.size();
  return std::exchange(ended_, {});
}

}  // namespace fieldcast::forward
