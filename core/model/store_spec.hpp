// Data that a bridge or a station stores, the place, and the retention time. A plain value.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/time.hpp"

namespace fieldcast {

struct StoreSpec {
  std::string address;  // A file, or postgresql://.. (may contain a password: never log it)
  std::vector<std::string> samples{"*"};        // patterns of the channels to store
  Duration keep = std::chrono::hours{30 * 24};  // samples; 0: unlimited
  std::uint64_t max_bytes = 0;  // of a file; then the oldest samples are deleted; 0: no limit
  Duration keep_minutes = std::chrono::hours{365 * 24};  // aggregates per minute; 0: unlimited
  Duration keep_hours = std::chrono::hours{3650 * 24};   // aggregates per hour; 0: unlimited
  friend bool operator==(const StoreSpec&, const StoreSpec&) = default;
};

}  // namespace fieldcast
