// What one message carries: samples of one device, the catalogue of a device, or the state of an
// alarm. Plain values; pure functions.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bridge/dds/topics/history_values.hpp"
#include "bridge/dds/topics/topic_values.hpp"
#include "core/base/cause.hpp"
#include "core/base/time.hpp"
#include "core/base/value.hpp"

namespace fieldcast::forward {

struct BatchSample {
  std::uint32_t channel = 0;   // index in the catalogue of the device
  std::uint64_t sequence = 0;  // number of the sample in its channel and epoch
  UtcTime acquired_at;
  Value value;
  Quality quality = Quality::kGood;
  std::uint16_t device_code = 0;
  friend bool operator==(const BatchSample&, const BatchSample&) = default;
};

struct SampleBatch {
  std::string bus, device;
  std::uint64_t epoch = 0;           // of the bus; greater after each restart of the bus
  std::uint64_t catalogue = 0;       // identity of the list to which `channel` refers
  std::vector<BatchSample> samples;  // by channel, then in the order of arrival
  friend bool operator==(const SampleBatch&, const SampleBatch&) = default;
};

// Channels of a device in the order in which they were announced.
struct DeviceCatalogue {
  std::string bus, device;
  std::vector<StationChannel> channels;
  friend bool operator==(const DeviceCatalogue&, const DeviceCatalogue&) = default;
};

// 64-bit hashes of the content. Equal contents have equal identities after each restart; identities
// of a batch differ if its device, epoch, channels or sequences differ.
[[nodiscard]] std::uint64_t identity_of(const SampleBatch& batch);
[[nodiscard]] std::uint64_t identity_of(const DeviceCatalogue& catalogue);
[[nodiscard]] std::uint64_t identity_of(const StationAlarmStatus& alarm);
[[nodiscard]] std::uint64_t identity_of(const AuditReport& entry);

// The newest sample of a channel, state of an alarm, or entry of a bridge's audit that was
// accepted.
struct Position {
  std::uint64_t epoch = 0;     // of an alarm: counts its states
  std::uint64_t sequence = 0;  // of an alarm: its identity; of the audit: the number
  friend bool operator==(const Position&, const Position&) = default;
};
[[nodiscard]] inline SampleNumber number_of(const Position& position) {
  return {position.epoch, position.sequence};
}
// Of the alarm's state after `known`; empty if that is the same state. An alarm can return to an
// earlier state, for example when a user ends its shelving; the count then makes it a new one.
[[nodiscard]] std::optional<Position> next_position(const Position& known,
                                                    const StationAlarmStatus& alarm);
// Whether the entry was accepted before. Epochs are not ordered: a bridge that restarts may have an
// earlier clock.
[[nodiscard]] inline bool is_known(const Position& known, const AuditReport& entry) {
  return entry.epoch == known.epoch && entry.number <= known.sequence;
}
struct NamedPosition {
  std::string name;  // "bus/device/channel", of an alarm followed by its limit
  Position position;
};

}  // namespace fieldcast::forward
