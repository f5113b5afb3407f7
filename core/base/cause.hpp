// Why an exchange, a value or a command failed: one enumerator, one text and one counter for each
// cause.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "core/base/quality.hpp"

namespace fieldcast {

enum class Cause : std::uint8_t {
  kNone,
  // the wire
  kNoAnswer,    // silence to the end of the timeout
  kTruncated,   // an answer began and did not end
  kChecksum,    // a whole frame with a wrong CRC, LRC, sum or XOR, theirs or (they say) ours
  kMalformed,   // right checksum, but lengths or fields that contradict each other or the request
  kForeign,     // only frames of another unit, function or transaction came
  kOverlong,    // more bytes than any frame of this protocol has
  kPortClosed,  // the port vanished during the exchange
  // why a port is closed
  kPortMissing,      // there is no such device file
  kPortDenied,       // the user may not open it
  kPortInUse,        // another program has it
  kPortUnreachable,  // no connection, or no module that dialled in
  // the device
  kDeviceError,  // the device refused, with a code of its own
  kDeviceBusy,   // the device, or the way to it, cannot at the moment; with a code of its own
  // values and commands
  kRange,  // outside the type, the scale or the configured limits
  kWrongType,
  kReadOnly,
  kUnknownChannel,
  kUnknownDevice,
  kBadAddress,     // no address of this protocol, or beyond its area
  kRawNotAllowed,  // the device does not allow commands to addresses
  kExpired,
  kDuplicate,
  kQueueFull,
  kRateLimited,
  kNotVerified,    // the value read back differs from the value written
  kLeased,         // the bus is leased to a programming session
  kForeignMaster,  // another master speaks on the wire: this bridge sends nothing
  kOffline,        // the device or its port is down
  kUnsupported,    // the protocol or the device cannot do this
  kShutdown,
  kWrongState,    // of an alarm: what is asked for does not apply to it now
  kLate,          // nothing failed: the wire was not free in time
  kNotAvailable,  // the device sent the raw value that means "no value"
  kCount          // not a cause: how many there are
};

// "no answer", "checksum error", ... for logs and results.
[[nodiscard]] std::string_view to_text(Cause cause);
// "NO_ANSWER", "CHECKSUM", ... for counters and JSON.
[[nodiscard]] std::string_view to_name(Cause cause);
[[nodiscard]] Cause cause_named(std::string_view name);  // kNone when no cause has this name
[[nodiscard]] Quality quality_of(Cause cause);           // of a sample whose reading failed by it

// One counter for each cause; never overflows in the life of a plant.
class CauseCounters {
 public:
  void add(Cause cause, std::uint64_t times = 1) {
    counts_[static_cast<std::size_t>(cause)] += times;
  }
  // One that was counted as `from` turns out to be `to`. REQUIRES: there is one.
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
