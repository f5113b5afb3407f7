// How far a sample may be trusted. The names are the contract of the Sample topic.
#pragma once

#include <cstdint>
#include <string_view>

namespace fieldcast {

enum class Quality : std::uint8_t {
  kGood,
  kUncertain,       // older than its refresh promises, or from a bus that is leased for programming
  kBadNoAnswer,     // the device is silent or its port is gone
  kBadFrame,        // answers arrive broken
  kBadDeviceError,  // the device refused; the sample carries its own code
  // The raw value has no meaning in the channel's type, or lies outside it after scaling.
  kBadRange,
  // The channel cannot work as configured (for instance its address does not exist in the device).
  kBadConfiguration,
  kNotYetRead,
};

[[nodiscard]] std::string_view to_text(Quality quality);  // "GOOD", "BAD_NO_ANSWER", ...

}  // namespace fieldcast
