#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <optional>

#include "bridge/dds/transport/domain.hpp"
#include "tests/bridge/dds/dds_support.hpp"
#include "tools/bench/support/lossy_receive.hpp"

namespace fieldcast::testing {
namespace {

using std::chrono::duration;
using std::chrono::steady_clock;

// Tests a network cut that is longer than the participant lease of 10 s: both sides must recover
// what did not change. The process receives nothing during the cut (lossy_receive.hpp).

class Counts {
 public:
  void add(const std::string& name) {
    const std::lock_guard lock(mutex_);
    ++counts_[name];
  }
  void clear() {
    const std::lock_guard lock(mutex_);
    counts_.clear();
  }
  [[nodiscard]] std::string lacking(const std::vector<std::string>& names) const {
    const std::lock_guard lock(mutex_);
    std::string all;
    for (const std::string& name : names) {
      if (!counts_.contains(name)) all += name + ' ';
    }
    return all;
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, int> counts_;
};

bool soon(const std::function<bool()>& condition) {  // the lease and the time of discovery
  return eventually(condition) || eventually(condition) || eventually(condition);
}

TEST(CutNetwork, WhatHasNotChangedIsThereAgain) {
  const std::string bus = bus_name("cut");
  Counts came, gone;
  DdsLink::Handlers handlers;
  handlers.clock = both_clocks;
  handlers.on_command = [](const std::string&, const Command&, const std::string&) {};
  handlers.on_interest = [&](const Interest& interest) {
    (interest.refresh ? came : gone).add("interest");
  };
  handlers.on_problem = [](const std::string&) {};
  handlers.bridges = {.found = [](auto&) {},
                      .received = [&](auto&, auto&&) { came.add("claims"); },
                      .alive = [](auto&, bool) {},
                      .lost = [&](auto&) { gone.add("claims"); }};
  DdsLink link(loopback(), "here", handlers);
  Received elsewhere;
  DdsLink::Handlers others = elsewhere.handlers();
  others.bridges = {[](auto&) {}, [](auto&, auto&&) {}, [](auto&, bool) {}, [](auto&) {}};
  DdsLink other(loopback(), "there", others);
  other.announce({.bridge = "there", .host = "host"});
  link.add_bus(bus_of(bus, 2));
  link.report(bus, PlanReport{}, {6});
  link.report({bus, "d", "c0", LimitKind::kHigh}, AlarmStatus{});
  link.report(bus, "d", DeviceReport{}, {7});

  std::atomic<std::uint64_t> sequence{0};
  Station station(loopback(), "watcher");
  station.subscribe_channels([&](const StationChannel&) { came.add("channel"); },
                             [&](auto&, auto&, auto&) { gone.add("channel"); });
  station.subscribe_samples([&](const StationSample& sample) { sequence = sample.sequence; },
                            [](auto&, auto&, auto&) {});
  station.subscribe_read_plans([&](const StationReadPlan&) { came.add("plan"); },
                               [&](const std::string&) { gone.add("plan"); });
  station.subscribe<StationDeviceDescription>(
      [&](const StationDeviceDescription&) { came.add("description"); },
      [&](const StationDeviceDescription&) { gone.add("description"); });
  station.subscribe_alarm_status([&](const StationAlarmStatus&) { came.add("alarm status"); },
                                 [&](const StationAlarmStatus&) { gone.add("alarm status"); });
  station.subscribe_device_status([&](const StationDeviceStatus&) { came.add("device status"); },
                                  [&](const StationDeviceStatus&) { gone.add("device status"); });
  station.declare_interest("cut/*/*", std::chrono::seconds{1});

  const std::vector<std::string> all{"channel",  "plan",   "alarm status", "device status",
                                     "interest", "claims", "description"};
  ASSERT_TRUE(eventually([&] { return came.lacking(all).empty(); })) << came.lacking(all);
  came.clear();
  bench::lose(1);
  EXPECT_TRUE(soon([&] { return gone.lacking(all).empty(); })) << gone.lacking(all);
  bench::lose(0);
  EXPECT_TRUE(soon([&] { return came.lacking(all).empty(); })) << came.lacking(all);
  for (std::uint64_t next = 1; next <= 3; ++next)
    link.publish(bus, std::vector{good(0, 0.5, next)}, both_clocks());
  EXPECT_TRUE(eventually([&] { return sequence == 3; }));
}

// Tests discovery with one lost datagram: the first, the second, and so on to the last of a join.
// A station and its bridge must match in both directions in time after each loss.

constexpr double kLongestJoin = 3;             // seconds
constexpr std::uint32_t kMostDatagrams = 400;  // of one join

TEST(DiscoveryLoss, AJoinNeedsNoSingleDatagram) {
  const std::string bus = bus_name("one-lost");
  Obedient bridge(bus);
  double longest = 0;
  std::uint32_t number = 0;
  for (bool is_lost = true; is_lost && number < kMostDatagrams; ++number) {
    const std::uint64_t before = bench::lost_datagrams();
    bench::lose_one(number);
    const auto began = steady_clock::now();
    Domain station(loopback(), "station", nullptr);
    dds::DataWriter* commands =
        station.writer(kCommandTopic, command_writer_qos(std::chrono::seconds{5}), "station");
    dds::DataReader* results =
        station.reader(kCommandResultTopic, nullptr, dds::StatusMask::none());
    EXPECT_TRUE(eventually([&] {
      dds::PublicationMatchedStatus readers;
      dds::SubscriptionMatchedStatus writers;
      commands->get_publication_matched_status(readers);
      results->get_subscription_matched_status(writers);
      return readers.current_count == 1 && writers.current_count == 1;
    })) << "datagram "
        << number << " was lost";
    const double seconds = duration<double>(steady_clock::now() - began).count();
    EXPECT_LT(seconds, kLongestJoin) << "datagram " << number << " was lost";
    longest = std::max(longest, seconds);
    is_lost = bench::lost_datagrams() > before;
  }
  bench::lose_one(-1);
  std::printf("%u joins, the longest %.2f s\n", number, longest);
  EXPECT_GT(number, 1u);
}

}  // namespace
}  // namespace fieldcast::testing
