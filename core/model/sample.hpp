// Channels are numbered within their bus, in the order of the devices and of their channels.
#pragma once

#include <cstdint>

#include "core/base/cause.hpp"
#include "core/base/time.hpp"
#include "core/base/value.hpp"

namespace fieldcast {

using ChannelIndex = std::uint32_t;  // within a bus
using DeviceIndex = std::uint16_t;   // within a bus

// Sample::device_code with kBadRange: the device sent the value that means "no value".
inline constexpr std::uint16_t kNotAvailableCode = 1;
// With kBadRange: the expression of a calculated channel has no finite result.
inline constexpr std::uint16_t kNoResultCode = 2;

struct Sample {
  ChannelIndex channel = 0;
  Value value;  // if the quality is bad, the last good one; before the first, false / 0 / ""
  Quality quality = Quality::kNotYetRead;
  std::uint16_t device_code = 0;  // with kBadDeviceError; or one of the codes above
  Instant acquired = kLongAgo;  // arrival of the last byte of the response; kLongAgo if never read
  std::uint64_t sequence = 0;   // increases with each sample of the channel; 0 if there is none
};

}  // namespace fieldcast
