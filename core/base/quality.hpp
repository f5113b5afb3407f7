// Reliability of a sample. The names are the contract of the Sample topic.
#pragma once

#include <cstdint>
#include <string_view>

namespace fieldcast {

enum class Quality : std::uint8_t {
  kGood,
  kUncertain,       // older than its refresh promises, or from a bus that is leased for programming
  kBadNoAnswer,     // the device is silent or its port is lost
  kBadFrame,        // responses are broken
  kBadDeviceError,  // the device refused; the sample contains its code
  // The raw value is invalid for the channel's type, or outside it after scaling.
  kBadRange,
  // The channel cannot work as configured, for example because its address does not exist.
  kBadConfiguration,
  kNotYetRead,
};

[[nodiscard]] std::string_view to_text(Quality quality);  // "GOOD", "BAD_NO_ANSWER", ...

}  // namespace fieldcast
