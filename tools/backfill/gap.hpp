// Samples of a channel that were published but not received, between two that were. Plain values;
// pure functions.
#pragma once

#include <string>

#include "bridge/dds/topics/history_values.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

struct Gap {
  std::string path;    // "bus/device/channel"
  SampleNumber after;  // the last sample before the gap; without an epoch, `since` decides
  SampleNumber until;  // the first sample after the gap; identifies a gap of a channel
  UtcTime since;       // only samples that were published at or after this time
  friend bool operator==(const Gap&, const Gap&) = default;
};

// A gap was found or became smaller, or it was closed.
struct GapChange {
  Gap gap;
  bool is_closed = false;
  friend bool operator==(const GapChange&, const GapChange&) = default;
};

// True if samples may be missing between two that were received one after the other. Of an earlier
// epoch, the last number is not known.
[[nodiscard]] inline bool is_gap(const SampleNumber& before, const SampleNumber& present) {
  if (before.epoch == 0 || present.epoch < before.epoch) return false;
  return present.epoch != before.epoch || present.sequence > before.sequence + 1;
}

}  // namespace fieldcast
