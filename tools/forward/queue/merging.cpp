#include "tools/forward/queue/merging.hpp"

#include <algorithm>
#include <utility>

#include "tools/forward/payload/codec.hpp"

namespace fieldcast::forward {

void Merging::add(Record record, bool can_merge) {
  if (record.kind == RecordKind::kSamples) {
    const auto known = groups_.find(lane_of(record));
    if (can_merge && known != groups_.end() && join(known->second, record)) {
      result_.removed.push_back(record.id);
      return;
    }
    if (known != groups_.end()) {
      end(known->second);
      groups_.erase(known);
    }
    if (can_merge)
      groups_.emplace(lane_of(record), Group{result_.records.size(), record.body.size(), {}});
  }
  result_.records.push_back(std::move(record));
}

bool Merging::join(Group& group, const Record& record) {
  const Record& first = result_.records[group.record];
  if (record.epoch != first.epoch || group.bytes + record.body.size() > most_bytes_) return false;
  auto batch = decode_samples(record.body);
  if (group.parts.empty()) {
    auto begin = decode_samples(first.body);
    if (!begin) return false;
    group.parts.push_back(*std::move(begin));
  }
  std::size_t samples = batch ? batch->samples.size() : 0;
  for (const SampleBatch& part : group.parts) samples += part.samples.size();
  if (!batch || batch->catalogue != group.parts.front().catalogue || samples > most_samples_)
    return false;
  group.bytes += record.body.size();
  group.parts.push_back(*std::move(batch));
  return true;
}

void Merging::end(const Group& group) {
  if (group.parts.size() < 2) return;
  Record& record = result_.records[group.record];
  SampleBatch batch = group.parts.front();
  for (auto part = group.parts.begin() + 1; part != group.parts.end(); ++part)
    batch.samples.insert(batch.samples.end(), part->samples.begin(), part->samples.end());
  std::stable_sort(
      batch.samples.begin(), batch.samples.end(),
      [](const BatchSample& a, const BatchSample& b) { return a.channel < b.channel; });
  batch.bus = record.bus;
  batch.device = record.device;
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
