#include "tests/tools/forward/batch_support.hpp"

#include <filesystem>
#include <stdexcept>

#include "tools/forward/payload/codec.hpp"

namespace fieldcast::forward {

StationChannel channel(const std::string& name) {
  return {.bridge = "b",
          .bus = "line",
          .device = "press",
          .channel = name,
          .type = "float32",
          .unit = "°C",
          .at = "holding:1",
          .refresh = std::chrono::seconds{1}};
}

StationSample sample(const std::string& channel, std::uint64_t sequence, std::uint64_t epoch) {
  return {.bus = "line",
          .device = "press",
          .channel = channel,
          .value = 20.5,
          .quality = Quality::kGood,
          .acquired_at = {static_cast<std::int64_t>(sequence) * 1'000'000'000},
          .sequence = sequence,
          .epoch = epoch};
}

DeviceCatalogue catalogue(const std::vector<std::string>& names) {
  DeviceCatalogue made{"line", "press", {}};
  for (const std::string& name : names) made.channels.push_back(channel(name));
  return made;
}

SampleBatch seconds(std::int64_t from, std::int64_t to) {
  SampleBatch batch{"line", "press", 7, 99, {}};
  for (std::int64_t second = from; second < to; ++second)
    batch.samples.push_back({.sequence = static_cast<std::uint64_t>(second + 1),
                             .acquired_at = {second * 1'000'000'000},
                             .value = 1.0});
  return batch;
}

Record record_of(const SampleBatch& batch) {
  return {.bus = batch.bus,
          .device = batch.device,
          .epoch = batch.epoch,
          .identity = identity_of(batch),
          .samples = static_cast<std::uint32_t>(batch.samples.size()),
          .body = encode(batch)};
}

AuditReport audit() {
  return {.bridge = "plant",
          .epoch = 7,
          .number = 3,
          .at = {1'764'360'000'000'000'001},
          .who = "fieldcast/anna",
          .what = "write 21.5",
          .target = "line/press/setpoint",
          .bytes_to_device = 8,
          .bytes_from_device = 9,
          .result = "done"};
}

StationAlarmStatus alarm() {
  StationAlarmStatus made;
  made.alarm = {"line", "press", "level", LimitKind::kHighHigh};
  made.status.priority = AlarmPriority::kCritical;
  made.status.stage = AlarmStage::kAcknowledged;
  made.status.active = true;
  made.status.value = 101.5;
  made.status.raised_at = {5'000'000'000};
  made.status.acknowledged = {"ann", "on my way", {6'000'000'000}};
  made.status.shelved = {"ann", "oil", {7'000'000'000}, {8'000'000'000}};
  return made;
}

Folder::Folder() {
  std::string pattern = std::filesystem::temp_directory_path() / "fieldcast-forward-XXXXXX";
  if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
  path_ = pattern;
}

Folder::~Folder() { std::filesystem::remove_all(path_); }

}  // namespace fieldcast::forward
