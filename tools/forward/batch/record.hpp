// One message that waits in the queue, and the lane in which it is sent. Plain values.
#pragma once

#include <compare>
#include <cstdint>
#include <string>

#include "core/base/time.hpp"

namespace fieldcast::forward {

// The numbers are stored.
enum class RecordKind : std::uint8_t { kSamples = 0, kCatalogue = 1, kAlarm = 2, kAudit = 3 };

struct Record {
  std::uint64_t id = 0;  // ascending in the order of Queue::append()
  RecordKind kind = RecordKind::kSamples;
  std::string bus, device;     // of the audit: the bridge, and empty
  std::uint64_t epoch = 0;     // of samples, or of the bridge; of an alarm: counts its states
  std::uint64_t identity = 0;  // of the whole content; thinning does not change it
  std::uint32_t samples = 0;
  // Samples that were published long before they are sent. Consumers that need only present values
  // ignore them.
  bool is_late = false;
  std::string body;  // protobuf
};

// Records of one lane are sent one after the other; lanes are independent.
struct Lane {
  RecordKind kind = RecordKind::kSamples;
  bool is_late = false;
  std::string bus, device;
  friend auto operator<=>(const Lane&, const Lane&) = default;
};
[[nodiscard]] inline Lane lane_of(const Record& record) {
  return {record.kind, record.is_late, record.bus, record.device};
}

}  // namespace fieldcast::forward
