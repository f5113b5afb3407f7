// Receives the interests from DDS: keeps their table and posts to each bus what changed for its
// channels. Any thread.
//
// note() only writes the table. A thread of the registry's own finds what the interests mean for
// channels, at most every kPace: a station that changes its interests a million times costs neither
// DDS nor a bus more than one that does so a few times a second.
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

  // `remark` is called on the registry's thread with one line for the log for each interest that
  // changes nothing.
  explicit InterestRegistry(std::function<void(std::string)> remark);
  ~InterestRegistry();
  InterestRegistry(const InterestRegistry&) = delete;
  InterestRegistry& operator=(const InterestRegistry&) = delete;

  // The bus gets the interests of now, and every change until it is removed; nothing afterwards.
  void add(const BusSpec& bus, std::shared_ptr<BusRunner> runner);
  void remove(const std::string& bus);

  // All buses are there: from here on an interest that meets no channel is remarked.
  void all_added();

  // No station is interested in anything any more.
  void forget();

  // As InterestTable::note().
  [[nodiscard]] tl::expected<void, std::string> note(const std::string& station,
                                                     const std::string& pattern,
                                                     std::optional<Duration> refresh);

 private:
  struct Bus {
    BusSpec spec;
    std::map<ChannelIndex, Duration> known;  // the registry's thread only
    std::mutex mutex;
    std::shared_ptr<BusRunner> runner;  // null: removed
  };
  using Buses = std::map<std::string, std::shared_ptr<Bus>, std::less<>>;
  void run();
  static void update(const InterestTable& table, Bus& bus);
  void remark_on(const std::vector<InterestTable::NewInterest>& added, const Buses& buses);

  std::function<void(std::string)> remark_;
  RepeatFilter remarked_;  // the registry's thread only; by station

  std::mutex mutex_;
  std::condition_variable changed_;
  bool dirty_ = false, all_added_ = false, ending_ = false;
  InterestTable table_;
  Buses buses_;
  std::thread thread_;  // last: it uses what is above
};

}  // namespace fieldcast
