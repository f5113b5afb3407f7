// Interests of all stations, and the resulting refresh of each channel: the shortest one requested.
// Pure; guarded by its owner.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <tl/expected.hpp>
#include <utility>
#include <vector>

#include "core/bus/setup/event.hpp"
#include "core/model/bus_spec.hpp"
#include "core/model/channel_pattern.hpp"

namespace fieldcast {

class InterestTable {
 public:
  static constexpr std::size_t kMaxInterests = 4096;  // new interests beyond it are refused
  // Different patterns; limits the work of one change.
  static constexpr std::size_t kMaxPatterns = 256;
  // Interests between two take_new(); more are not reported as new.
  static constexpr std::size_t kMaxNew = 256;
  // Limits of a refresh, as in a configuration.
  static constexpr Duration kShortest = std::chrono::milliseconds{1};
  static constexpr Duration kLongest = std::chrono::hours{24};

  // Sets the refresh at which a station is interested in the channels of a pattern; `std::nullopt`
  // ends the interest. The error is one line for the log.
  [[nodiscard]] tl::expected<void, std::string> note(const std::string& station,
                                                     const std::string& pattern,
                                                     std::optional<Duration> refresh);

  // Returns the refresh of every on-interest channel with an interested station.
  [[nodiscard]] std::map<ChannelIndex, Duration> interests(const BusSpec& bus) const;

  struct NewInterest {
    std::string station;
    Pattern pattern;
  };
  [[nodiscard]] std::vector<NewInterest> take_new() { return std::exchange(new_, {}); }

  // Number of channels of a bus that a pattern matches, and how many of them are read on interest.
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
  std::map<std::string, Interested> patterns_;  // by the pattern's text; none is without stations
  std::size_t count_ = 0;
  std::vector<NewInterest> new_;
};

[[nodiscard]] std::vector<InterestChanged> changes(const std::map<ChannelIndex, Duration>& before,
                                                   const std::map<ChannelIndex, Duration>& after);

}  // namespace fieldcast
