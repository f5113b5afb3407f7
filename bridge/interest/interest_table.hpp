// The interests of all stations, and what they mean for each channel: the shortest refresh that
// anybody asks for. Pure; guarded by its owner.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <tl/expected.hpp>
#include <utility>
#include <vector>

#include "core/bus/event.hpp"
#include "core/model/pattern.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

class InterestTable {
 public:
  static constexpr std::size_t kMaxInterests = 4096;  // a new one beyond that is refused
  static constexpr std::size_t kMaxPatterns = 256;    // distinct; bounds the work of one change
  // Interests between two take_new(); more are not reported as new.
  static constexpr std::size_t kMaxNew = 256;
  // The limits of a refresh, as in a configuration.
  static constexpr Duration kShortest = std::chrono::milliseconds{1};
  static constexpr Duration kLongest = std::chrono::hours{24};

  // A station is interested in the channels of the pattern at this refresh, or (nothing) no longer.
  // The error is one line for the log.
  [[nodiscard]] tl::expected<void, std::string> note(const std::string& station,
                                                     const std::string& pattern,
                                                     std::optional<Duration> refresh);

  // The refresh of every channel that is read on interest and that a station is interested in, by
  // the channel index of the bus.
  [[nodiscard]] std::map<ChannelIndex, Duration> interests(const BusSpec& bus) const;

  struct NewInterest {
    std::string station;
    Pattern pattern;
  };
  // Interests that are new since the last call.
  [[nodiscard]] std::vector<NewInterest> take_new() { return std::exchange(new_, {}); }

  // The channels of a bus that a pattern meets, and how many of them are read on interest.
  struct Reach {
    std::size_t channels = 0, on_interest = 0;
    Reach& operator+=(const Reach& more) {
      channels += more.channels, on_interest += more.on_interest;
      return *this;
    }
  };
  [[nodiscard]] static Reach reach(const Pattern& pattern, const BusSpec& bus);

 private:
  struct Interested {
    Pattern pattern;
    std::map<std::string, Duration> stations;
  };
  std::map<std::string, Interested> patterns_;  // by their text; none is empty
  std::size_t count_ = 0;
  std::vector<NewInterest> new_;
};

// The events for a bus whose interests were `before` and are `after`.
[[nodiscard]] std::vector<InterestChanged> changes(const std::map<ChannelIndex, Duration>& before,
                                                   const std::map<ChannelIndex, Duration>& after);

}  // namespace fieldcast
