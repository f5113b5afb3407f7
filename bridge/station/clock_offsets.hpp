// Estimates by how much this machine's clock is ahead of each bridge's, from the times in its
// messages. Pure; one owner. Arrival minus time of writing is the offset plus the time on the way:
// the smallest within a window is too large by some milliseconds, and never too small.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "core/base/time.hpp"

namespace fieldcast {

// Above it commands expire early or run late, and ages of samples are wrong.
inline constexpr Duration kLargestClockOffset = std::chrono::seconds{1};

class ClockOffsets {
 public:
  // An estimate is over one to two windows: after a step of a clock it is right that much later.
  static constexpr Duration kWindow = std::chrono::seconds{15};
  // Buses of all bridges; beyond it, only a bus silent for two windows is replaced.
  static constexpr std::size_t kMostBuses = 4096;

  // Adds a status written at `written` by the bridge's clock and received at `arrived` by this
  // one's. Returns the offset, or empty: the first message of a bus may be late and is ignored.
  std::optional<Duration> add(const std::string& bridge, const std::string& bus, UtcTime written,
                              UtcTime arrived, Instant now);

 private:
  struct Peer {
    std::set<std::string> buses;
    std::optional<Duration> least, least_before;  // of this window and of the one before
    Instant since{}, last{};
  };
  void forget_silent(Instant now);

  std::map<std::string, Peer> peers_;
  std::size_t buses_ = 0;
};

}  // namespace fieldcast
