#include "core/base/cause.hpp"

#include <algorithm>
#include <numeric>

namespace fieldcast {

namespace {

struct Row {
  std::string_view name;
  std::string_view text;
  Quality quality;
};

constexpr std::array<Row, static_cast<std::size_t>(Cause::kCount)> kRows{{
    {"NONE", "no error", Quality::kGood},
    {"NO_ANSWER", "no response", Quality::kBadNoResponse},
    {"TRUNCATED", "incomplete response", Quality::kBadFrame},
    {"CHECKSUM", "checksum error", Quality::kBadFrame},
    {"MALFORMED", "malformed response", Quality::kBadFrame},
    {"FOREIGN", "response of another device or request", Quality::kBadFrame},
    {"OVERLONG", "response too long", Quality::kBadFrame},
    {"PORT_CLOSED", "port closed", Quality::kBadNoResponse},
    {"PORT_MISSING", "no such device file", Quality::kBadNoResponse},
    {"PORT_DENIED", "permission denied", Quality::kBadNoResponse},
    {"PORT_IN_USE", "in use by another program", Quality::kBadNoResponse},
    {"PORT_UNREACHABLE", "no connection", Quality::kBadNoResponse},
    {"DEVICE_ERROR", "refused by the device", Quality::kBadDeviceError},
    {"DEVICE_BUSY", "device not ready", Quality::kBadDeviceError},
    {"RANGE", "value out of range", Quality::kBadRange},
    {"WRONG_TYPE", "value of the wrong type", Quality::kBadConfiguration},
    {"READ_ONLY", "channel is read-only", Quality::kBadConfiguration},
    {"UNKNOWN_CHANNEL", "unknown channel", Quality::kBadConfiguration},
    {"UNKNOWN_DEVICE", "unknown device", Quality::kBadConfiguration},
    {"BAD_ADDRESS", "no such address", Quality::kBadConfiguration},
    {"RAW_NOT_ALLOWED", "commands to addresses are not allowed on this device",
     Quality::kBadConfiguration},
    {"EXPIRED", "expired before it could run", Quality::kUncertain},
    {"DUPLICATE", "duplicate of an earlier command", Quality::kUncertain},
    {"QUEUE_FULL", "too many commands are waiting", Quality::kUncertain},
    {"RATE_LIMITED", "written too often", Quality::kUncertain},
    {"NOT_VERIFIED", "the value read back differs", Quality::kBadDeviceError},
    {"LEASED", "bus is leased to a programming session", Quality::kUncertain},
    {"FOREIGN_MASTER", "another master is on the wire", Quality::kUncertain},
    {"OFFLINE", "device is offline", Quality::kBadNoResponse},
    {"UNSUPPORTED", "not supported by the device or its protocol", Quality::kBadConfiguration},
    {"SHUTDOWN", "bridge is shutting down", Quality::kUncertain},
    {"WRONG_STATE", "not possible in this state", Quality::kUncertain},
    {"LATE", "not read in time", Quality::kUncertain},
    {"NOT_AVAILABLE", "the device has no value", Quality::kBadRange},
}};

const Row& row(Cause cause) { return kRows[static_cast<std::size_t>(cause)]; }

}  // namespace

std::string_view to_text(Cause cause) { return row(cause).text; }
std::string_view to_name(Cause cause) { return row(cause).name; }
Cause cause_named(std::string_view name) {
  const auto found =
      std::find_if(kRows.begin(), kRows.end(), [&](const Row& one) { return one.name == name; });
  return found == kRows.end() ? Cause::kNone : static_cast<Cause>(found - kRows.begin());
}
Quality quality_of(Cause cause) { return row(cause).quality; }

std::uint64_t CauseCounters::total() const {
  return std::accumulate(counts_.begin() + 1, counts_.end(), std::uint64_t{0});
}

std::string_view to_text(Quality quality) {
  switch (quality) {
    case Quality::kGood: return "GOOD";
    case Quality::kUncertain: return "UNCERTAIN";
    case Quality::kBadNoResponse: return "BAD_NO_ANSWER";
    case Quality::kBadFrame: return "BAD_FRAME";
    case Quality::kBadDeviceError: return "BAD_DEVICE_ERROR";
    case Quality::kBadRange: return "BAD_RANGE";
    case Quality::kBadConfiguration: return "BAD_CONFIGURATION";
    case Quality::kNotYetRead: return "NOT_YET_READ";
  }
  return "?";
}

}  // namespace fieldcast
