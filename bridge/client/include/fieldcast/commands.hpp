/// @file
/// Commands to channels and their results. Plain values; any thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "fieldcast/values.hpp"

namespace fieldcast::api {
inline namespace v1 {

/// Times above 24 h count as 24 h.
struct CommandOptions {
  bool verify = false;  ///< write: the bridge reads the value back
  /// The bridge never starts the command later than this after it was sent.
  Duration lifespan = std::chrono::seconds{5};
  Duration wait_for_bridge = std::chrono::seconds{3};  ///< until the bridge of the bus is found
  Duration wait_for_result = std::chrono::seconds{5};  ///< beyond the lifespan
  /// The user for whom the station acts, for the audit: 1 to 64 letters, digits, '-', '_', '.',
  /// '@'.
  std::string person;
};

/// Values at an address of a device, with or without a channel there. The bridge reads and writes
/// such addresses only if the device has `allow: [raw-read, raw-write]` in its configuration.
struct Address {
  std::string at;               ///< in the notation of the PLC: "holding:100", "DB5.DBW2"
  std::string type = "uint16";  ///< as in the configuration: "bool", "float32", "string(16)"
  /// Bit of a bool in a wider item, or the lowest bit of an 8-bit type in it.
  std::optional<std::uint8_t> bit{};
  bool low_word_first = false;  ///< false: the usual order of the device family
  bool low_byte_first = false;
  double scale = 1, offset = 0;  ///< value = raw * scale + offset
};

enum class Outcome : std::uint8_t {
  kDone,      ///< the device confirmed
  kVerified,  ///< and the value read back is the one written
  kRejected,  ///< nothing was sent to the device
  kFailed,  ///< the device did not confirm; the reason says whether the write may have taken effect
  kExpired,   ///< the lifespan ended first; nothing was sent to the device
  kNotSent,   ///< this station could not send it: no bridge serves the bus, or the name is wrong
  kNoResult,  ///< it was sent, and no result arrived in time
};
[[nodiscard]] std::string_view to_text(Outcome outcome);  ///< "done", "verified", "not sent", ...

struct Result {
  Outcome outcome = Outcome::kNotSent;
  std::string cause;   ///< "READ_ONLY", ...; empty if there is none
  std::string reason;  ///< one line for the user; empty if done
  std::uint16_t device_code = 0;
  std::vector<Value> values;  ///< read back or acquired
  Time received_at, started_at, completed_at;
  [[nodiscard]] bool ok() const {
    return outcome == Outcome::kDone || outcome == Outcome::kVerified;
  }
};
/// "verified", "rejected: channel is read-only (READ_ONLY)", "no result: ...".
[[nodiscard]] std::string to_text(const Result& result);

}  // namespace v1
}  // namespace fieldcast::api
