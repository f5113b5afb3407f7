#include "tools/station/stream/stream_recorder.hpp"

#include <algorithm>

namespace fieldcast::web {

std::vector<UtcTime> stored_times(const StreamBatch& batch) {
  const std::vector<forward::BatchSample>& samples = batch.samples.samples;
  const UtcTime latest{saturated_sum(batch.stored_at.nanoseconds, kMaxAhead.count())};
  const auto is_timed = [latest](const forward::BatchSample& sample) {
    return sample.quality == Quality::kGood && sample.acquired_at <= latest;
  };
  UtcTime newest, newest_good;
  for (const forward::BatchSample& sample : samples) {
    if (sample.acquired_at <= latest) newest = std::max(newest, sample.acquired_at);
    if (is_timed(sample)) newest_good = std::max(newest_good, sample.acquired_at);
  }
  UtcTime bound = batch.is_late ? newest : batch.stored_at;
  if (newest_good != UtcTime{}) bound = newest_good;
  bound = std::min(bound, batch.stored_at);
  std::vector<UtcTime> times(samples.size());
  for (std::size_t i = samples.size(); i-- > 0;) {
    const bool is_last = i + 1 == samples.size() || samples[i + 1].channel != samples[i].channel;
    if (is_timed(samples[i])) {
      times[i] = samples[i].acquired_at;
    } else if (is_last) {
      times[i] = bound;
    } else if (is_timed(samples[i + 1])) {
      times[i] = std::min(bound, UtcTime{saturated_difference(times[i + 1].nanoseconds, 1)});
    } else {
      times[i] = times[i + 1];
    }
  }
  return times;
}

StreamRecorder::Device& StreamRecorder::device_of(const StreamBatch& batch) {
  Device& device = devices_[batch.samples.bus + '/' + batch.samples.device];
  if (device.catalogue == batch.samples.catalogue && !device.by_index.empty()) return device;
  device.catalogue = batch.samples.catalogue;
  device.by_index.clear();
  for (const StationChannel& channel : batch.catalogue->channels) {
    const auto known = device.channels.find(channel.channel);
    if (known == device.channels.end() && channels_ >= kMaxChannels) {
      device.by_index.push_back(nullptr);
      continue;
    }
    if (known == device.channels.end()) ++channels_;
    Channel& to = device.channels[channel.channel];
    to.number = store_.number_of({.bus = batch.samples.bus,
                                  .device = batch.samples.device,
                                  .channel = channel.channel,
                                  .unit = channel.unit,
                                  // As stored by a bridge: "string(16)" becomes "string".
                                  .type = channel.type.substr(0, channel.type.find('('))});
    device.by_index.push_back(&to);
  }
  return device;
}

void StreamRecorder::add_late(const StreamBatch& batch, const std::vector<SampleRow>& rows) {
  const auto [first, last] = std::ranges::minmax_element(rows, {}, &SampleRow::published_at);
  LateRange range{first->published_at, last->published_at, rows.size(), batch.stored_at};
  const auto known = std::ranges::find_if(late_, [&](const Late& late) {
    return late.bus == batch.samples.bus && late.device == batch.samples.device &&
           is_near(late.range, range);
  });
  if (known == late_.end()) {
    late_.push_back({batch.samples.bus, batch.samples.device, range});
  } else {
    known->range = joined(known->range, range);
  }
}

std::size_t StreamRecorder::record(const StreamBatch& batch) {
  const Device& device = device_of(batch);
  const std::vector<UtcTime> times = stored_times(batch);
  std::vector<SampleRow> rows;
  rows.reserve(times.size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    const forward::BatchSample& sample = batch.samples.samples[i];
    Channel* const channel = device.by_index[sample.channel];
    if (channel == nullptr) {
      ++counters_.unknown;
      continue;
    }
    if (!channel->number) continue;
    if (!channel->received.add(batch.samples.epoch, sample.sequence)) {
      ++counters_.repeated;
      continue;
    }
    rows.push_back({.channel = *channel->number,
                    .published_at = times[i],
                    .acquired_at = sample.acquired_at,
                    .sequence = sample.sequence,
                    .quality = sample.quality,
                    .device_code = sample.device_code,
                    .value = sample.value});
  }
  counters_.recorded += rows.size();
  if (batch.is_late && !rows.empty()) add_late(batch, rows);
  store_.put(rows);
  return rows.size();
}

}  // namespace fieldcast::web
