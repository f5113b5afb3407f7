// Reliability of a sample. The names are the contract of the Sample topic.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace fieldcast {

enum class Quality : std::uint8_t {
  kGood,
  kUncertain,       // older than its refresh promises, or from a bus that is leased for programming
  kBadNoResponse,   // the device is silent or its port is lost
  kBadFrame,        // responses are broken
  kBadDeviceError,  // the device refused; the sample contains its code
  // The raw value is invalid for the channel's type, or outside it after scaling.
  kBadRange,
  // The channel cannot work as configured, for example because its address does not exist.
  kBadConfiguration,
  kNotYetRead,
};

[[nodiscard]] std::string_view to_text(Quality quality);  // "GOOD", "BAD_NO_ANSWER", ...

// Reason of a failure, with one text and one counter per cause.
enum class Cause : std::uint8_t {
  kNone,
  // Wire:
  kNoResponse,  // no byte until the timeout
  kTruncated,   // an incomplete response
  // A whole frame with a wrong CRC, LRC, sum or XOR; or the device reports that of the request.
  kChecksum,
  kMalformed,   // valid checksum, but lengths or fields contradict each other or the request
  kForeign,     // only frames of another unit, function or transaction arrived
  kOverlong,    // more bytes than any frame of this protocol has
  kPortClosed,  // the port was lost during the exchange
  // Closed port:
  kPortMissing,      // the device file does not exist
  kPortDenied,       // the user has no permission to open it
  kPortInUse,        // another program uses it
  kPortUnreachable,  // no connection, or no dialled-in module
  // Device:
  kDeviceError,  // the device refused, with its own code
  kDeviceBusy,   // the device, or the path to it, is temporarily unable; with its own code
  // Values and commands:
  kRange,  // outside the type, the scale or the configured limits
  kWrongType,
  kReadOnly,
  kUnknownChannel,
  kUnknownDevice,
  kBadAddress,     // not an address of this protocol, or beyond its area
  kRawNotAllowed,  // the device does not allow commands to addresses
  kExpired,
  kDuplicate,
  kQueueFull,
  kRateLimited,
  kNotVerified,    // the value read back differs from the value written
  kLeased,         // the bus is leased to a programming session
  kForeignMaster,  // another master uses the wire: this bridge does not send
  kOffline,        // the device or its port is not available
  kUnsupported,    // the protocol or the device does not support this
  kShutdown,
  kWrongState,    // of an alarm: the action does not apply to its present state
  kLate,          // no failure: the wire was not free in time
  kNotAvailable,  // the device sent the raw value that means "no value"
  kCount          // not a cause: their number
};

// "no response", "checksum error", ... for logs and results.
[[nodiscard]] std::string_view to_text(Cause cause);
// "NO_ANSWER", "CHECKSUM", ... for counters and JSON.
[[nodiscard]] std::string_view to_name(Cause cause);
[[nodiscard]] Cause cause_named(std::string_view name);  // kNone if no cause has this name
[[nodiscard]] Quality quality_of(Cause cause);           // of a sample that could not be read

class CauseCounters {
 public:
  void add(Cause cause, std::uint64_t times = 1) {
    counts_[static_cast<std::size_t>(cause)] += times;
  }
  // REQUIRES: one `from` was counted.
  void move(Cause from, Cause to) {
    --counts_[static_cast<std::size_t>(from)];
    add(to);
  }
  [[nodiscard]] std::uint64_t operator[](Cause cause) const {
    return counts_[static_cast<std::size_t>(cause)];
  }
  [[nodiscard]] std::uint64_t total() const;  // all but kNone

 private:
  std::array<std::uint64_t, static_cast<std::size_t>(Cause::kCount)> counts_{};
};

}  // namespace fieldcast
