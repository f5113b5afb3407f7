// Interests of all stations, and the shortest refresh of each channel. Pure; guarded by its owner.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <tl/expected.hpp>
#include <utility>
#include <vector>

#include "bridge/bus/bus_runner.hpp"
#include "bridge/log/log_lines.hpp"
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

  // Shortest refreshes of inputs of calculated channels with an interested station, and of the
  // inputs of these inputs. `buses`: all of the bridge.
  using InputRefreshes = std::map<ChannelPath, Duration>;
  [[nodiscard]] InputRefreshes input_refreshes(const std::vector<const BusSpec*>& buses) const;

  // Returns the refresh of every on-interest channel with an interested station, or that is one of
  // these inputs.
  [[nodiscard]] std::map<ChannelIndex, Duration> interests(const BusSpec& bus,
                                                           const InputRefreshes& inputs = {}) const;

  struct NewInterest {
    std::string station;
    Pattern pattern;
  };
  [[nodiscard]] std::vector<NewInterest> take_new() { return std::exchange(new_, {}); }

  // Number of channels of a bus that a pattern matches, and how many of them are read on interest
  // or calculated, so that their inputs may be.
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
  struct Match {
    const Pattern* pattern;
    Duration refresh;
  };
  // Patterns that may match channels of the bus, the shortest refresh first.
  [[nodiscard]] std::vector<Match> matches_of(const BusSpec& bus) const;

  std::map<std::string, Interested> patterns_;  // by the pattern's text; none is without stations
  std::size_t count_ = 0;
  std::vector<NewInterest> new_;
};

[[nodiscard]] std::vector<InterestChanged> changes(const std::map<ChannelIndex, Duration>& before,
                                                   const std::map<ChannelIndex, Duration>& after);

// Stores the interests received from DDS and posts the resulting changes of channels to each bus.
// note() only writes to the table; the registry's own thread computes the changes, at most every
// kPace: a station that changes its interests often costs DDS and the buses little. Any thread.
class InterestRegistry {
 public:
  static constexpr std::chrono::milliseconds kPace{50};

  // Calls `remark` on the registry's thread with a log line for each interest without effect.
  explicit InterestRegistry(std::function<void(std::string)> remark);
  ~InterestRegistry();
  InterestRegistry(const InterestRegistry&) = delete;
  InterestRegistry& operator=(const InterestRegistry&) = delete;

  // The bus gets the present interests, and every change until it is removed.
  void add(const BusSpec& bus, std::shared_ptr<BusRunner> runner);
  void remove(const std::string& bus);

  // Call when all buses were added: from then on, interests that match no channel are reported.
  void all_added();

  void forget();

  // See InterestTable::note().
  [[nodiscard]] tl::expected<void, std::string> note(const std::string& station,
                                                     const std::string& pattern,
                                                     std::optional<Duration> refresh);

 private:
  struct Bus {
    BusSpec spec;
    std::map<ChannelIndex, Duration> known;  // only on the registry's thread
    std::mutex mutex;
    std::shared_ptr<BusRunner> runner;  // null: removed
  };
  using Buses = std::map<std::string, std::shared_ptr<Bus>, std::less<>>;
  void run();
  static void update(std::map<ChannelIndex, Duration> interests, Bus& bus);
  void remark_on(const std::vector<InterestTable::NewInterest>& added, const Buses& buses);

  std::function<void(std::string)> remark_;
  RepeatFilter remarked_;  // by station; only on the registry's thread

  std::mutex mutex_;
  std::condition_variable changed_;
  bool dirty_ = false, all_added_ = false, ending_ = false;
  InterestTable table_;
  Buses buses_;
  std::thread thread_;  // last: it uses the members above
};

}  // namespace fieldcast
