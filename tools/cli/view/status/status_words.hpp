// Explains qualities, states and counters in words. Pure functions.
#pragma once

#include <string>
#include <string_view>

#include "bridge/station/station.hpp"

namespace fieldcast::cli {

// "the device, or the way to it, is silent: look at its power, cable and address".
[[nodiscard]] std::string_view quality_words(Quality quality);

// What to check for this cause: "baud rate, parity and stop bits"; may be empty.
[[nodiscard]] std::string_view advice(Cause cause);

// Most frequent first: "no response 12 times, checksum error 3 times .. and 2 more causes". `most`:
// maximum number; 0: all.
[[nodiscard]] std::string causes_words(const CauseCounts& causes, std::size_t most = 0);

// "running", "closed: no such device file. Look at ...": state, reason and fix.
[[nodiscard]] std::string bus_words(const StationBusStatus& bus);

// "this machine's clock is 10.0 s ahead of the clock of bridge line-7", with the effect and the
// remedy if the clocks do not agree.
[[nodiscard]] std::string clock_words(const std::string& bridge, Duration ahead);
// Whether they differ by at most kLargestClockOffset.
[[nodiscard]] bool clocks_agree(Duration ahead);

// "offline: its bus is closed (no such device file)", "offline: it does not respond ...". The bus
// may be null: unknown.
[[nodiscard]] std::string device_words(const StationDeviceStatus& device,
                                       const StationBusStatus* bus);

}  // namespace fieldcast::cli
