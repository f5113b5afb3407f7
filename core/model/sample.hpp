// One value of a channel as it leaves the engine. Channels are numbered within their bus: devices
// in the order of the spec, and the channels of a device in theirs.
#pragma once

#include <cstdint>

#include "core/base/cause.hpp"
#include "core/base/quality.hpp"
#include "core/base/time.hpp"
#include "core/base/value.hpp"

namespace fieldcast {

using ChannelIndex = std::uint32_t;  // within a bus
using DeviceIndex = std::uint16_t;   // within a bus

// Sample::device_code with kBadRange: the device sent what means "no value".
inline constexpr std::uint16_t kNotAvailableCode = 1;

struct Sample {
  ChannelIndex channel = 0;
  Value value;  // the last good one when the quality is bad; false / 0 / "" before the first
  Quality quality = Quality::kNotYetRead;
  std::uint16_t device_code = 0;  // with kBadDeviceError; kNotAvailableCode
  Instant acquired = kLongAgo;    // arrival of the answer's last byte; kLongAgo: never read
  std::uint64_t sequence = 0;     // grows with each sample of the channel; 0: none yet
};

}  // namespace fieldcast
