// Stores the interests received from DDS and posts the resulting channel changes to each bus. Any
// thread.
//
// note() only writes to the table. The registry's own thread computes the changes of channels, at
// most every kPace. A station that changes its interests very often therefore costs DDS and the
// buses no more than a few changes a second.
#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <tl/expected.hpp>

#include "bridge/bus/bus_runner.hpp"
#include "bridge/interest/interest_table.hpp"
#include "bridge/log/repeat_filter.hpp"

namespace fieldcast {

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
  static void update(const InterestTable& table, Bus& bus);
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
