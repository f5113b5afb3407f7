// Samples as a WriteRequest of Prometheus Remote-Write 1.0. Pure; one owner.
#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>
#include <utility>

#include "tools/forward/batch/sample_batch.hpp"

namespace fieldcast::forward {

// A server refuses a whole request if it contains a second sample of a series for one time. A
// value that becomes bad twice, or a calculated one, has several samples of one acquisition time:
// only the first one is encoded.
class WriteRequestEncoder {
 public:
  explicit WriteRequestEncoder(std::string site) : site_(std::move(site)) {}

  // The series fieldcast_value and fieldcast_sequence of each channel and quality. Texts and
  // samples without an acquisition time have no series. The result of several batches may be
  // joined: the series follow each other. Empty if nothing can be sent.
  [[nodiscard]] std::string encode(const SampleBatch& batch, const DeviceCatalogue& catalogue);

 private:
  struct Last {
    std::int64_t at = 0;  // milliseconds; 0: none
    std::uint64_t sequence = 0;
  };
  // False if another sample of this channel and quality has the time.
  [[nodiscard]] bool is_first(const SampleBatch& batch, const BatchSample& sample,
                              const std::string& channel);

  const std::string site_;
  std::unordered_map<std::string, Last> last_;  // by channel and quality
};

// A block of snappy, which Prometheus requires.
[[nodiscard]] std::string snappy_block(const std::string& text);

}  // namespace fieldcast::forward
