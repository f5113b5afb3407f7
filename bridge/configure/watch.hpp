// Decides what happens to a new configuration after it is in force: whether channels that were good
// before turned bad, and when the old configuration returns. Pure: state, event, now.
#pragma once

#include <chrono>
#include <map>
#include <string>
#include <vector>

#include "core/base/cause.hpp"
#include "core/base/time.hpp"

namespace fieldcast::configure {

// The last quality of each channel that is configured now, by "bus/device/channel".
using ChannelQualities = std::map<std::string, Quality>;

struct Watch {
  static constexpr Duration kLength = std::chrono::seconds{30};
  // A reload waits for engineers who program devices.
  static constexpr Duration kLongestReload = std::chrono::minutes{2};
  // A bridge that restarts more often within a watch fails by the new configuration.
  static constexpr int kMostRestarts = 1;

  enum class State : std::uint8_t {
    kReloading,  // the file is replaced, and the bridge does not use it yet
    kWatching,
  };

  std::string version, base;  // the new version, and the one that returns
  std::string who;
  State state = State::kReloading;
  Instant until{};                // end of this state
  std::vector<std::string> good;  // channels that were good before
  int restarts = 0;               // of the bridge since the deployment
};
[[nodiscard]] std::string_view to_text(Watch::State state);

// Channels that were good before, are still configured, and are bad now or not read at all: "bus/
// device/channel BAD_NO_ANSWER". A channel that was removed or renamed was meant to end.
[[nodiscard]] std::vector<std::string> worse_channels(const Watch& watch,
                                                      const ChannelQualities& now);

// The channels that are good.
[[nodiscard]] std::vector<std::string> good_channels(const ChannelQualities& now);

enum class WatchEnd : std::uint8_t { kNone, kKeep, kRollBack };
struct WatchStep {
  WatchEnd end = WatchEnd::kNone;
  std::string reason;  // one line
};

// `refusal`: why the bridge did not load the file; empty if it did. Begins the watch.
[[nodiscard]] WatchStep reloaded(Watch& watch, const std::string& refusal, Instant now);
// Call it regularly, with the qualities of now.
[[nodiscard]] WatchStep looked(const Watch& watch, const ChannelQualities& qualities, Instant now);
// The bridge has started again within the watch: a full watch follows, or the old file returns.
[[nodiscard]] WatchStep restarted(Watch& watch, bool is_valid, Instant now);

}  // namespace fieldcast::configure
