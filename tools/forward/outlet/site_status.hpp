// The state of a forwarder, for the log, the metrics and the centre. A plain value.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/time.hpp"

namespace fieldcast::forward {

struct SiteStatus {
  std::string site;
  UtcTime at, started_at;  // by the clock of this machine
  bool is_connected = false;
  // The queue.
  std::uint64_t backlog_records = 0, backlog_bytes = 0;
  UtcTime oldest_at;  // of the queue; 0 if it is empty
  std::uint64_t thinned_samples = 0, dropped_samples = 0, dropped_records = 0;
  // Since the start.
  std::uint64_t acknowledged_samples = 0, late_samples = 0;
  std::uint64_t acknowledged_messages = 0, acknowledged_bytes = 0;
  std::uint64_t repeated_messages = 0, refused_messages = 0;
  std::uint64_t lost_samples = 0;  // the queue could not be written
  std::uint64_t devices = 0;
  std::uint64_t open_gaps = 0;  // of channels, whose missing samples are fetched
};

// {"schema":1,"site":"north","at":1764360000000000000,"backlog_records":12,..}; times are Unix
// nanoseconds, and `oldest_at` is null if the queue is empty.
[[nodiscard]] std::string to_json(const SiteStatus& status);

}  // namespace fieldcast::forward
