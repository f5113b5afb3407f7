// Samples, batches and catalogues for the tests of the forwarder.
#pragma once

#include <string>
#include <vector>

#include "tools/forward/batch/sample_batch.hpp"
#include "tools/forward/queue/queue.hpp"

namespace fieldcast::forward {

// A channel of line/press.
[[nodiscard]] StationChannel channel(const std::string& name);
// A good sample of line/press, acquired at `sequence` seconds.
[[nodiscard]] StationSample sample(const std::string& channel, std::uint64_t sequence,
                                   std::uint64_t epoch = 7);
[[nodiscard]] DeviceCatalogue catalogue(const std::vector<std::string>& names);
// One sample of channel 0 for each second of [from, to).
[[nodiscard]] SampleBatch seconds(std::int64_t from, std::int64_t to);
[[nodiscard]] Record record_of(const SampleBatch& batch);
[[nodiscard]] StationAlarmStatus alarm();
[[nodiscard]] AuditReport audit();

// A folder that is removed at the end.
class Folder {
 public:
  Folder();
  ~Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::string file(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

}  // namespace fieldcast::forward
