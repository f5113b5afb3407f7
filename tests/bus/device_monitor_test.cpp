#include "core/bus/health/device_monitor.hpp"

#include <gtest/gtest.h>

#include "core/bus/health/device_health.hpp"
#include "tests/bus/rtu_bus.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using test::kHolding;

const Request kRead = ReadRequest{{{kHolding, 100, 1}}};
const Request kWrite = WriteRequest{{kHolding, 100, 1}, {0, 1}, {}};

class DeviceMonitorTest : public testing::Test {
 protected:
  static std::vector<std::optional<Range>> probed() { return {Range{kHolding, 100, 1}, {}}; }
  void tried(DeviceIndex device, Cause cause, Instant at, ByteView received = {}) {
    monitor_.tried({device, cause, 1s, at, received, {}}, at, sink_);
  }
  bool fail(DeviceIndex device, Cause cause, Instant at) {
    tried(device, cause, at);
    return monitor_.failed(device, cause, at, sink_);
  }
  void take_offline(DeviceIndex device, Instant at) {
    EXPECT_FALSE(fail(device, Cause::kNoResponse, at));
    EXPECT_TRUE(fail(device, Cause::kNoResponse, at));
  }
  std::optional<DeviceMonitor::Probe> probe(Instant now, Duration slack = 10s,
                                            Instant gate = kLongAgo) {
    return monitor_.probe(
        now, [=](DeviceIndex, const Request&) { return gate; }, [=] { return slack; });
  }
  std::vector<Notice::Kind> notices() {
    std::vector<Notice::Kind> kinds;
    for (const Action& action : actions_) kinds.push_back(std::get<Notice>(action).kind);
    actions_.clear();
    return kinds;
  }

  BusSetup setup_{test::rtu_bus(2)};
  DeviceMonitor monitor_{setup_, probed()};
  std::uint64_t samples_ = 0;
  Actions actions_;
  ActionSink sink_{setup_, samples_, actions_};
};

using Kinds = std::vector<Notice::Kind>;

TEST_F(DeviceMonitorTest, SilenceTakesADeviceOfflineAndAResponseBringsItBack) {
  take_offline(0, Instant{1s});
  EXPECT_TRUE(monitor_.offline(0));
  EXPECT_FALSE(monitor_.all_offline());
  EXPECT_EQ(notices(), Kinds{Notice::Kind::kDeviceLost});
  monitor_.responded(0, sink_);
  EXPECT_FALSE(monitor_.offline(0));
  EXPECT_EQ(notices(), Kinds{Notice::Kind::kDeviceBack});
  EXPECT_EQ(monitor_.report(0).failures, 2u);
}

TEST_F(DeviceMonitorTest, BrokenResponsesAreErrorsAndNoLoss) {
  monitor_.responded(0, sink_);
  EXPECT_FALSE(fail(0, Cause::kChecksum, Instant{1s}));
  EXPECT_EQ(notices(), Kinds{Notice::Kind::kDeviceErrors});
  EXPECT_EQ(monitor_.report(0).causes[Cause::kChecksum], 1u);
}

TEST_F(DeviceMonitorTest, BytesThatAreNoResponseAreSaidOnceTheyRepeat) {
  const Bytes garbage{0x00, 0xF8, 0x80};
  for (int i = 0; i < 3; ++i) tried(0, Cause::kTruncated, Instant{1s}, garbage);
  EXPECT_EQ(notices(), Kinds{Notice::Kind::kGarbage});
  tried(0, Cause::kNone, Instant{2s});
  EXPECT_EQ(notices(), Kinds{Notice::Kind::kGarbageEnded});
}

TEST_F(DeviceMonitorTest, AnEchoIsSaidWhereNobodyEverResponded) {
  const Bytes request{1, 3, 0, 0, 0, 1, 0x84, 0x0A};
  const auto echoed = [&] {
    for (int i = 0; i < 3; ++i)
      monitor_.tried(
          {.device = 0, .cause = Cause::kNoResponse, .sent = request, .echo_alone = true},
          Instant{1s}, sink_);
  };
  echoed();
  EXPECT_EQ(notices(), Kinds{Notice::Kind::kGarbage});
  tried(0, Cause::kNone, Instant{2s});
  EXPECT_EQ(notices(), Kinds{Notice::Kind::kGarbageEnded});
  echoed();
  EXPECT_EQ(notices(), Kinds{}) << "the adapter is known, and the device is silent";
}

TEST_F(DeviceMonitorTest, WhatWasLearnedShortensTheWaitForReadsAlone) {
  for (int i = 0; i < 20; ++i) monitor_.learn(0, kRead, 5ms);
  EXPECT_LT(monitor_.timeout(0, kRead, false), 200ms);
  EXPECT_EQ(monitor_.timeout(0, kRead, true), 200ms) << "a command's";
  EXPECT_EQ(monitor_.timeout(1, kRead, false), 200ms) << "another device";
  const Duration before = monitor_.timeout(0, kRead, false);
  monitor_.learn(0, kWrite, 100ms);
  EXPECT_EQ(monitor_.timeout(0, kRead, false), before) << "writing takes a time of its own";
}

TEST_F(DeviceMonitorTest, ALostDeviceIsForgotten) {
  for (int i = 0; i < 20; ++i) monitor_.learn(0, kRead, 5ms);
  tried(0, Cause::kNone, Instant{1s});
  EXPECT_EQ(monitor_.rest_before(0, Instant{3s}), 2s);
  EXPECT_EQ(monitor_.report(0).areas.size(), 1u);
  take_offline(0, Instant{4s});
  EXPECT_EQ(monitor_.timeout(0, kRead, false), 200ms);
  EXPECT_EQ(monitor_.rest_before(0, Instant{5s}), Duration::max());
  EXPECT_TRUE(monitor_.report(0).areas.empty());
}

TEST_F(DeviceMonitorTest, LateResponsesCountForTheLongest) {
  monitor_.learn(0, kRead, 5ms);
  monitor_.learn_late(0, 150ms);
  EXPECT_EQ(monitor_.longest_response(0), 150ms);
  EXPECT_EQ(monitor_.longest_response(1), 0ms);
}

TEST_F(DeviceMonitorTest, ABusyDeviceIsLeftAlone) {
  EXPECT_FALSE(monitor_.suspension(0, Instant{1s})) << "as the scheduler knows";
  tried(0, Cause::kDeviceBusy, Instant{1s});
  monitor_.busy(0, Instant{1s});
  const auto until = monitor_.suspension(0, Instant{1s});
  EXPECT_EQ(until, Instant{1s} + DeviceMonitor::kBusyPause);
  EXPECT_EQ(monitor_.suspension(0, Instant{2s}), Instant{2s}) << "the end is told once";
  EXPECT_FALSE(monitor_.suspension(0, Instant{3s}));
}

TEST_F(DeviceMonitorTest, ADeviceStaysBusyAfterTwoSuchResponsesInARow) {
  tried(0, Cause::kDeviceBusy, Instant{1s});
  EXPECT_FALSE(monitor_.stays_busy(0));
  tried(0, Cause::kNone, Instant{1s});
  tried(0, Cause::kDeviceBusy, Instant{1s});
  EXPECT_FALSE(monitor_.stays_busy(0)) << "the device has responded between them";
  tried(0, Cause::kDeviceBusy, Instant{1s});
  EXPECT_TRUE(monitor_.stays_busy(0));
  tried(0, Cause::kNoResponse, Instant{1s});
  EXPECT_TRUE(monitor_.stays_busy(0));
  tried(0, Cause::kDeviceError, Instant{1s});
  EXPECT_FALSE(monitor_.stays_busy(0));
}

TEST_F(DeviceMonitorTest, OnlySilenceAfterAShortRestLengthensThePause) {
  const auto pause_after = [&](unsigned in_flight, Cause cause) {
    BusSpec bus = test::rtu_bus(2);
    bus.in_flight = in_flight;
    const BusSetup setup(bus);
    DeviceMonitor monitor(setup, probed());
    for (int i = 0; i < 12; ++i) {
      monitor.tried({.device = 0, .rest = 5s}, Instant{1s}, sink_);
      monitor.tried({.device = 0, .cause = cause, .rest = 1ms}, Instant{1s}, sink_);
    }
    EXPECT_EQ(monitor.paused_until(0), Instant{1s} + monitor.report(0).pause);
    return monitor.report(0).pause;
  };
  EXPECT_EQ(pause_after(1, Cause::kNoResponse), 2ms);
  EXPECT_EQ(pause_after(1, Cause::kChecksum), 0ms) << "the device has received the request";
  EXPECT_EQ(pause_after(1, Cause::kNone), 0ms);
  EXPECT_EQ(pause_after(2, Cause::kNoResponse), 0ms) << "a second request hides the rest";
}

TEST_F(DeviceMonitorTest, AnExchangeLastsAtMostForTheTimeoutIfTheDeviceMayNotRespond) {
  const Duration wire = setup_.wire_time(0, kRead) + setup_.silence();
  EXPECT_EQ(monitor_.longest_exchange(0, kRead), wire + 200ms) << "nothing is known of it";
  for (int i = 0; i < 20; ++i) monitor_.learn(0, kRead, 5ms);
  EXPECT_EQ(monitor_.longest_exchange(0, kRead), wire + 5ms);
  monitor_.gateway_read_ended(0, Cause::kNoResponse, Instant{1s});
  EXPECT_EQ(monitor_.longest_exchange(0, kRead), wire + 200ms);
  monitor_.gateway_read_ended(0, Cause::kNone, Instant{1s});
  EXPECT_EQ(monitor_.longest_exchange(0, kRead), wire + 5ms);
  for (int i = 0; i < 3; ++i) tried(0, Cause::kChecksum, Instant{1s});
  EXPECT_EQ(monitor_.longest_exchange(0, kRead), wire + 200ms) << "it is sick";
}

TEST_F(DeviceMonitorTest, AnExchangeWithADeviceThatIsNotConfiguredMayBreakAtTheLastMoment) {
  DeviceSpec other = setup_.device(0);
  other.link.address = 9;
  other.pause = 30ms;
  ASSERT_TRUE(setup_.set_ad_hoc(2, other));
  monitor_.replaced(2);
  for (int i = 0; i < 20; ++i) monitor_.learn(2, kRead, 5ms);
  EXPECT_EQ(monitor_.longest_exchange(2, kRead), setup_.wire_time(2, kRead) + setup_.silence() +
                                                     30ms + 200ms +
                                                     2 * setup_.spec().gap_allowance);
}

TEST_F(DeviceMonitorTest, ResponseTimesThatAnotherBridgeHasLearnedAreKnown) {
  DeviceReport learned;
  learned.response_time = 5ms;
  learned.areas = {{std::string(setup_.area(0, kHolding).name), 7ms, {}, 0, 0},
                   {std::string(setup_.area(0, 0).name), 0ms, {}, 0, 0},
                   {"none of this protocol", 9ms, {}, 0, 0}};
  monitor_.inherit(0, learned);
  monitor_.inherit(1, {});
  const DeviceReport report = monitor_.report(0);
  EXPECT_EQ(report.response_time, 5ms);
  ASSERT_EQ(report.areas.size(), 1u);
  EXPECT_EQ(report.areas[0].area, learned.areas[0].area);
  EXPECT_EQ(report.areas[0].response_time, 7ms);
  EXPECT_LT(monitor_.timeout(0, kRead, false), 200ms);
  EXPECT_EQ(monitor_.longest_exchange(1, kRead),
            setup_.wire_time(1, kRead) + setup_.silence() + 200ms)
      << "the other bridge had no response of it";
}

TEST_F(DeviceMonitorTest, AnOfflineDeviceIsSuspendedPermanently) {
  take_offline(0, Instant{1s});
  EXPECT_EQ(monitor_.suspension(0, Instant{1s}), kNever);
}

TEST_F(DeviceMonitorTest, ASickDeviceWaitsForTimeToWaste) {
  monitor_.defer_if_sick(0, 200ms, Instant{1s});
  EXPECT_FALSE(monitor_.suspension(0, Instant{1s})) << "it is well";
  for (int i = 0; i < 3; ++i) tried(0, Cause::kChecksum, Instant{1s});
  EXPECT_TRUE(monitor_.sick(0));
  monitor_.defer_if_sick(0, 200ms, Instant{1s});
  EXPECT_EQ(monitor_.suspension(0, Instant{1s}), kNever);

  std::vector<DeviceIndex> admitted;
  const auto admit = [&](Instant now, Duration slack) {
    return monitor_.admit_deferred(
        now, [=] { return slack; }, admitted);
  };
  EXPECT_EQ(admit(Instant{2s}, 100ms), Instant{3s}) << "ten times what it wasted";
  EXPECT_TRUE(admitted.empty());
  EXPECT_EQ(admit(Instant{2s}, 300ms), kNever) << "the wire can afford another failure";
  EXPECT_EQ(admitted, std::vector<DeviceIndex>{0});
}

TEST_F(DeviceMonitorTest, AnOfflineDeviceIsProbedEverMoreRarely) {
  take_offline(0, Instant{1s});
  EXPECT_EQ(monitor_.next_probe(), Instant{1500ms});
  EXPECT_FALSE(probe(Instant{1400ms}));
  const auto due = probe(Instant{1500ms});
  ASSERT_TRUE(due);
  EXPECT_EQ(due->timeout, 200ms);
  EXPECT_FALSE(fail(0, Cause::kNoResponse, Instant{1700ms}));
  EXPECT_EQ(monitor_.next_probe(), Instant{2700ms});
}

TEST_F(DeviceMonitorTest, AProbeTakesWhatTheWireCanSpare) {
  take_offline(0, Instant{1s});
  EXPECT_FALSE(probe(Instant{1500ms}, 0ms));
  EXPECT_EQ(monitor_.next_probe(), Instant{1500ms} + DeviceMonitor::kProbeRetry);
  EXPECT_FALSE(probe(Instant{1520ms}, 100ms)) << "a longer pause of the wire may come";
  const auto shorter = probe(Instant{1500ms} + DeviceMonitor::kProbePatience, 100ms);
  ASSERT_TRUE(shorter);
  EXPECT_LT(shorter->timeout, 100ms);
  const auto overdue = probe(Instant{1500ms} + DeviceHealth::kLastProbe, 0ms);
  ASSERT_TRUE(overdue);
  EXPECT_EQ(overdue->timeout, DeviceMonitor::kShortestProbe);
}

TEST_F(DeviceMonitorTest, AProbeWaitsForResponsesThatAreOwed) {
  take_offline(0, Instant{1s});
  EXPECT_FALSE(probe(Instant{1500ms}, 10s, Instant{1800ms}));
  EXPECT_EQ(monitor_.next_probe(), Instant{1800ms});
  monitor_.opened(Instant{1600ms});
  EXPECT_EQ(monitor_.next_probe(), Instant{1600ms}) << "on the new line it may answer";
}

TEST_F(DeviceMonitorTest, ADeviceWithoutPointsIsNeverProbed) {
  take_offline(1, Instant{1s});
  EXPECT_EQ(monitor_.next_probe(), kNever);
  EXPECT_FALSE(probe(Instant{100s}));
}

// A read that lets other bridges hear this one: the shortest of a healthy device.
struct SignTest : DeviceMonitorTest {
  SignTest() {
    learn(0, 100ms);
    learn(1, 5ms);
  }
  void learn(DeviceIndex device, Duration response) {
    for (int i = 0; i < 4; ++i) both_.learn(device, kRead, response);
  }
  void make_sick(DeviceIndex device) {
    for (int i = 0; i < 3; ++i)
      both_.tried({device, Cause::kChecksum, 1s, Instant{1s}, {}, {}}, Instant{1s}, sink_);
    both_.defer_if_sick(device, 200ms, Instant{1s});
  }
  std::optional<DeviceIndex> sign(std::optional<DeviceIndex> waits = {}) const {
    const auto gate = [=](DeviceIndex device, const Request&) {
      return device == waits ? Instant{3s} : kLongAgo;
    };
    const auto found = both_.sign(Instant{2s}, gate);
    return found ? std::optional(found->device) : std::nullopt;
  }
  const Range range_{kHolding, 100, 1};
  DeviceMonitor both_{setup_, {range_, range_}};
};

TEST_F(SignTest, IsTheShortestRead) {
  EXPECT_EQ(sign(), DeviceIndex{1});
  EXPECT_EQ(both_.sign(Instant{2s}, [](DeviceIndex, const Request&) { return kLongAgo; })->timeout,
            setup_.wire_time(1, kRead) + 5ms + setup_.silence());
}

TEST_F(SignTest, OfADeviceThatOwesAResponseWaits) {
  EXPECT_EQ(sign(DeviceIndex{1}), DeviceIndex{0});
}

TEST_F(SignTest, OfASickDeviceIsSentOnlyIfNoOtherIsHealthy) {
  make_sick(1);
  EXPECT_EQ(sign(), DeviceIndex{0});
  EXPECT_EQ(sign(DeviceIndex{0}), DeviceIndex{1});
  make_sick(0);
  EXPECT_EQ(sign(), DeviceIndex{1}) << "the shorter one of two";
}

TEST_F(SignTest, OfADeviceAfterASickOneIsPreferred) {
  make_sick(0);
  learn(1, 150ms);
  EXPECT_EQ(sign(), DeviceIndex{1});
}

TEST(DeviceHealth, SilenceTakesItOffline) {
  DeviceHealth health;
  EXPECT_TRUE(health.responded());
  EXPECT_TRUE(health.failed(Cause::kNoResponse, Instant{1s}));
  EXPECT_EQ(health.state(), DeviceState::kDegraded);
  EXPECT_TRUE(health.failed(Cause::kNoResponse, Instant{2s}));
  EXPECT_TRUE(health.offline());
}

TEST(DeviceHealth, BrokenResponsesShowThatSomebodyIsThere) {
  DeviceHealth health;
  (void)health.responded();
  for (int i = 0; i < 100; ++i) (void)health.failed(Cause::kChecksum, Instant{1s});
  EXPECT_EQ(health.state(), DeviceState::kDegraded);
}

TEST(DeviceHealth, WhatRespondsBrokenFromTheBeginningIsNotUnknown) {
  DeviceHealth health;
  EXPECT_TRUE(health.failed(Cause::kForeign, Instant{1s}));
  EXPECT_EQ(health.state(), DeviceState::kDegraded);
  DeviceHealth silent;
  EXPECT_FALSE(silent.failed(Cause::kNoResponse, Instant{1s}));
  EXPECT_EQ(silent.state(), DeviceState::kUnknown);
}

// Busy is a temporary state, unless it lasts long without any other response.
TEST(DeviceHealth, ADeviceThatStaysBusyGoesOffline) {
  DeviceHealth health;
  (void)health.responded();
  EXPECT_FALSE(health.failed(Cause::kDeviceBusy, Instant{1s})) << "one answer shows little";
  EXPECT_TRUE(health.failed(Cause::kDeviceBusy, Instant{2s}));
  EXPECT_EQ(health.state(), DeviceState::kDegraded);
  EXPECT_FALSE(health.failed(Cause::kDeviceBusy, Instant{10s}));
  EXPECT_TRUE(health.failed(Cause::kDeviceBusy, Instant{1s} + DeviceHealth::kBusyToOffline));
  EXPECT_TRUE(health.offline());
  EXPECT_TRUE(health.responded());
  EXPECT_FALSE(health.failed(Cause::kDeviceBusy, Instant{20s})) << "the time begins again";
  EXPECT_EQ(health.state(), DeviceState::kOnline);
}

TEST(DeviceHealth, IsProbedEverMoreRarely) {
  DeviceHealth health;
  Instant now{};
  for (unsigned i = 0; i < DeviceHealth::kFailuresToOffline; ++i)
    (void)health.failed(Cause::kNoResponse, now);
  Duration before{};
  for (int i = 0; i < 10; ++i) {
    const Duration interval = health.probe_at() - now;
    EXPECT_GE(interval, before);
    EXPECT_LE(interval, DeviceHealth::kLastProbe);
    before = interval;
    now = health.probe_at();
    EXPECT_FALSE(health.failed(Cause::kNoResponse, now)) << "no news";
  }
  EXPECT_EQ(before, DeviceHealth::kLastProbe);
}

TEST(DeviceHealth, OneResponseBringsItBack) {
  DeviceHealth health;
  for (int i = 0; i < 5; ++i) (void)health.failed(Cause::kNoResponse, Instant{1s});
  EXPECT_TRUE(health.responded());
  EXPECT_EQ(health.state(), DeviceState::kOnline);
  EXPECT_EQ(health.probe_at(), kNever);
  EXPECT_FALSE(health.responded());
}

}  // namespace
}  // namespace fieldcast
