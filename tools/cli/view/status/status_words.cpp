#include "tools/cli/view/status/status_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "bridge/station/clock_offsets.hpp"

namespace fieldcast::cli {
namespace {

struct Advice {
  Cause cause;
  std::string_view text;
};

constexpr std::string_view kLineSettings =
    "bytes arrive that are not responses: on a serial line, check baud rate, parity and stop bits, "
    "and for a second device of this address; the bridge's log says what the bytes look like";
constexpr std::array kAdvice{
    Advice{Cause::kNoResponse, "look at its power, its cable, its address and the baud rate"},
    Advice{Cause::kTruncated, kLineSettings},
    Advice{Cause::kChecksum, kLineSettings},
    Advice{Cause::kMalformed, kLineSettings},
    Advice{Cause::kForeign, "look for a second device of this address, or another master"},
    Advice{Cause::kOverlong, kLineSettings},
    Advice{Cause::kPortClosed, "the other side closes the connection when it is polled"},
    Advice{Cause::kPortMissing, "look whether the adapter is plugged in, and at `port`"},
    Advice{Cause::kPortDenied, "the bridge's user must be in the group of the port (dialout)"},
    Advice{Cause::kPortInUse, "end the other program; fuser PORT names it"},
    Advice{Cause::kPortUnreachable, "look at host, port, network and the module's power"},
    Advice{Cause::kDeviceError, "look at the addresses of its channels"},
    Advice{Cause::kDeviceBusy, "it asks to be left alone for a while"},
    Advice{Cause::kLeased, "fieldcast sessions says who programs"},
    Advice{Cause::kForeignMaster, "look for another master on the wire"},
    Advice{Cause::kLate, "the wire is too busy: fieldcast plan says what would help"},
};

struct Counted {
  Cause cause;
  std::uint64_t count;
};

std::vector<Counted> by_count(const CauseCounts& causes) {
  std::vector<Counted> sorted;
  for (const auto& [name, count] : causes) {
    // An unknown name comes from a newer bridge.
    if (const Cause cause = cause_named(name); cause != Cause::kNone)
      sorted.push_back({cause, count});
  }
  std::ranges::stable_sort(sorted, std::ranges::greater{}, &Counted::count);
  return sorted;
}

std::string sentence_about(Cause cause) {
  const auto text = advice(cause);
  return text.empty() ? std::string{} : fmt::format("; {}", text);
}

bool says_why(const StationBusStatus& bus) {
  return bus.report.closed_because != Cause::kNone &&
         bus.report.closed_because != Cause::kPortClosed;
}

}  // namespace

std::string_view quality_words(Quality quality) {
  switch (quality) {
    case Quality::kGood: return "the device gave this value, and its refresh is kept";
    case Quality::kUncertain:
      return "the value was good once and is old now; nothing is known to be broken";
    case Quality::kBadNoResponse:
      return "the device, or the way to it, is silent: look at power, cable, address and port";
    case Quality::kBadFrame:
      return "bytes arrive that are not a valid response: check parity, baud rate, wiring, and for "
             "a "
             "second device of this address";
    case Quality::kBadDeviceError:
      return "the device reported that it cannot: most often it does not have this address";
    case Quality::kBadRange: return "the bytes are no value of this type: look at the type";
    case Quality::kBadConfiguration:
      return "this channel cannot be read from this device: look at its address and type";
    case Quality::kNotYetRead:
      return "no value came yet: it is read on demand (fieldcast acquire), or its first read is "
             "still to come";
  }
  return "";
}

std::string_view advice(Cause cause) {
  const auto found = std::ranges::find(kAdvice, cause, &Advice::cause);
  return found == kAdvice.end() ? std::string_view{} : found->text;
}

std::string causes_words(const CauseCounts& causes, std::size_t most) {
  const auto sorted = by_count(causes);
  const std::size_t shown = most == 0 ? sorted.size() : std::min(most, sorted.size());
  std::string text;
  for (std::size_t i = 0; i < shown; ++i)
    text += fmt::format("{}{} {} time{}", i == 0 ? "" : ", ", to_text(sorted[i].cause),
                        sorted[i].count, sorted[i].count == 1 ? "" : "s");
  if (shown < sorted.size())
    text += fmt::format(" .. and {} more cause{}", sorted.size() - shown,
                        sorted.size() - shown == 1 ? "" : "s");
  return text;
}

std::string bus_words(const StationBusStatus& bus) {
  switch (bus.report.state) {
    case BusState::kOpening: return "opening: its port is being opened";
    case BusState::kRunning: break;
    case BusState::kClosed:
      return says_why(bus) ? fmt::format("closed: {}{}", to_text(bus.report.closed_because),
                                         sentence_about(bus.report.closed_because))
                           : "closed: its port is not open; it is tried again";
    case BusState::kLeased:
      return "leased: an engineer programs a device; fieldcast sessions says who";
    case BusState::kStopped: return "stopped: its bridge ends or was requested to release it";
  }
  return bus.report.stretch > 1
             ? fmt::format(
                   "running, overloaded: every refresh takes {:.2f} times as long; fieldcast plan "
                   "says what would help",
                   bus.report.stretch)
             : "running";
}

std::string device_words(const StationDeviceStatus& device, const StationBusStatus* bus) {
  const auto sorted = by_count(device.causes);
  switch (device.report.state) {
    case DeviceState::kUnknown:
      if (device.report.exchanges == 0)
        return "unknown: it was not asked yet, or nothing of it is read by itself";
      return bus != nullptr && bus->report.state == BusState::kClosed
                 ? "unknown: the port of its bus is closed"
                 : "unknown: it has not responded yet";
    case DeviceState::kOnline: return "online";
    case DeviceState::kDegraded:
      return sorted.empty() ? std::string("degraded: some exchanges with it failed")
                            : fmt::format("degraded: exchanges with it fail: {}{}",
                                          causes_words(device.causes, 2),
                                          sentence_about(sorted.front().cause));
    case DeviceState::kOffline: break;
  }
  if (bus != nullptr && bus->report.state == BusState::kClosed)
    return fmt::format(
        "offline: the port of its bus is closed{}",
        says_why(*bus) ? fmt::format(" ({})", to_text(bus->report.closed_because)) : std::string{});
  if (sorted.empty()) return "offline: it does not respond";
  return fmt::format("offline: {}{}; it is polled less and less often until it responds",
                     causes_words(device.causes, 2), sentence_about(sorted.front().cause));
}

bool clocks_agree(Duration ahead) {
  return ahead <= kLargestClockOffset && ahead >= -kLargestClockOffset;
}

std::string clock_words(const std::string& bridge, Duration ahead) {
  const double seconds = to_seconds(ahead);
  if (clocks_agree(ahead))
    return fmt::format("this machine's clock and that of bridge {} differ by {:.3f} s", bridge,
                       std::abs(seconds));
  return fmt::format(
      "this machine's clock is {:.1f} s {} the clock of bridge {}: {}; synchronize both with NTP",
      std::abs(seconds), seconds > 0 ? "ahead of" : "behind", bridge,
      seconds > 0 ? "ages of samples are too large, and a command may run after its lifespan"
                  : "ages of samples are too small, and commands expire early");
}

}  // namespace fieldcast::cli
