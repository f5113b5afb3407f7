// Estimates by how much this machine's clock is ahead of the clock of each bridge, from the times
// that bridges write into their messages. Pure: no clock, no thread; one owner.
//
// A message arrives after it was written, so that its arrival minus its time of writing is the
// offset plus the time on the way. The smallest of these within a window has the least time on the
// way: the estimate is too large by that, some milliseconds, and never too small.
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
  // Buses of all bridges. Beyond it a new bus is ignored, unless others have been silent for two
  // windows: names come from the network.
  static constexpr std::size_t kMostBuses = 4096;

  // A bridge wrote a status of a bus at `written` by its clock; it arrived at `arrived` by this
  // machine's clock. Returns the offset, positive if this machine's clock is ahead; empty if it is
  // not known: the first message of a bus may have been kept for a late reader, and is ignored.
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
