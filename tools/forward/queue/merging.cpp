#include "tools/forward/queue/merging.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "tools/forward/payload/codec.hpp"

namespace fieldcast::forward {

void Merging::add(Record record, bool can_merge) {
  if (record.kind != RecordKind::kSamples) {
    result_.records.push_back(std::move(record));
    return;
  }
  const auto known = groups_.find(lane_of(record));
  auto batch = can_merge ? decode_samples(record.body) : std::nullopt;
  if (known != groups_.end()) {
    Group& group = known->second;
    const bool fits = batch && batch->epoch == group.batch.epoch &&
                      batch->catalogue == group.batch.catalogue &&
                      group.bytes + record.body.size() <= most_bytes_ &&
                      group.batch.samples.size() + batch->samples.size() <= most_samples_;
    if (fits) {
      group.bytes += record.body.size();
      ++group.parts;
      std::move(batch->samples.begin(), batch->samples.end(),
                std::back_inserter(group.batch.samples));
      result_.removed.push_back(record.id);
      return;
    }
    end(group);
    groups_.erase(known);
  }
  if (batch) {
    batch->bus = record.bus;
    batch->device = record.device;
    groups_.emplace(lane_of(record),
                    Group{result_.records.size(), *std::move(batch), record.body.size()});
  }
  result_.records.push_back(std::move(record));
}

void Merging::end(const Group& group) {
  if (group.parts == 1) return;
  SampleBatch batch = group.batch;
  std::stable_sort(
      batch.samples.begin(), batch.samples.end(),
      [](const BatchSample& a, const BatchSample& b) { return a.channel < b.channel; });
  Record& record = result_.records[group.record];
  record.identity = identity_of(batch);
  record.samples = static_cast<std::uint32_t>(batch.samples.size());
  record.body = encode(batch);
  result_.merged.insert(record.id);
}

Merging::Result Merging::take() {
  for (const auto& [lane, group] : groups_) end(group);
  groups_.clear();
  return std::exchange(result_, {});
}

}  // namespace fieldcast::forward
