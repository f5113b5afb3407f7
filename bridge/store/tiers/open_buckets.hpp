// Remembers which buckets of one tier were noted as open, so that the store notes each bucket once
// and not for every sample. A bucket that is no longer remembered is noted again, which only costs
// time. Pure; one owner, on the writer's thread.
#pragma once

#include <optional>
#include <unordered_map>

#include "bridge/store/tiers/bucket.hpp"

namespace fieldcast {

class OpenBuckets {
 public:
  explicit OpenBuckets(Duration width) : width_(width) {}

  // A sample of the channel was published at `at`. Returns its bucket if it must be noted now.
  [[nodiscard]] std::optional<UtcTime> touch(std::int64_t channel, UtcTime at) {
    const UtcTime start = bucket_start(at, width_);
    const auto [known, added] = newest_.try_emplace(channel, start);
    if (!added && known->second == start) return std::nullopt;
    known->second = start;
    return start;
  }
  // The bucket was written; a late sample notes it again.
  void close(std::int64_t channel, UtcTime start) {
    const auto known = newest_.find(channel);
    if (known != newest_.end() && known->second == start) newest_.erase(known);
  }
  void clear() { newest_.clear(); }

 private:
  const Duration width_;
  // Last bucket by channel; one entry for each channel of the store.
  std::unordered_map<std::int64_t, UtcTime> newest_;
};

}  // namespace fieldcast
