// The wishes of all stations, and what they mean for each channel: the shortest refresh that anybody wants. Pure; guarded by its
// owner.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "core/bus/event.hpp"
#include "core/model/pattern.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

class InterestBook {
 public:
  static constexpr std::size_t kMaxWishes = 4096;   // a new one beyond that is refused
  static constexpr std::size_t kMaxPatterns = 256;  // distinct; bounds the work of one change

  // A station wishes the channels of the pattern at this refresh, or not any more. The error is one line for the log.
  [[nodiscard]] tl::expected<void, std::string> note(const std::string& station, const std::string& pattern,
                                                     std::optional<Duration> refresh);

  // The wish for every channel that somebody wishes; channels of the bus in its own numbering.
  [[nodiscard]] std::map<ChannelIndex, Duration> wishes(const BusSpec& bus) const;

 private:
  struct Wishes {
    Pattern pattern;
    std::map<std::string, Duration> stations;
  };
  std::map<std::string, Wishes> patterns_;  // by their text; none is empty
  std::size_t count_ = 0;
};

// What has to be told to a bus whose wishes were `before` and are `after`.
[[nodiscard]] std::vector<InterestChanged> changes(const std::map<ChannelIndex, Duration>& before,
                                                   const std::map<ChannelIndex, Duration>& after);

}  // namespace fieldcast
