#include "tools/station/record/recorder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "bridge/store/event_table.hpp"
#include "tests/bridge/store/scratch.hpp"
#include "tests/bridge/store/store_support.hpp"

namespace fieldcast::web {
namespace {

using std::chrono::seconds;
using test::forever;
using test::history;
using test::Scratch;
using test::utc;
using testing::ElementsAre;

StationChannel channel(const std::string& bus, const std::string& name,
                       const std::string& unit = "bar") {
  StationChannel made;
  made.bus = bus;
  made.device = "d";
  made.channel = name;
  made.type = "float32";
  made.unit = unit;
  return made;
}

StationSample sample_of(const std::string& bus, const std::string& name, std::int64_t second,
                        std::uint64_t sequence, Value value = 1.5) {
  return {.bus = bus,
          .device = "d",
          .channel = name,
          .value = std::move(value),
          .quality = Quality::kGood,
          .acquired_at = utc(second),
          .sequence = sequence};
}

class RecorderTest : public testing::Test {
 protected:
  void start(StoreSpec spec) {
    store_.emplace(spec);
    recorder_.emplace(*store_);
  }
  void start() { start(forever(address_)); }
  void stop() {
    EXPECT_TRUE(store_->flush(seconds{30}));
    recorder_.reset();
    store_.reset();
  }
  [[nodiscard]] std::vector<std::uint64_t> sequences(const std::string& pattern) const {
    std::vector<std::uint64_t> found;
    for (const auto& each : history(address_, pattern)) found.push_back(each.sequence);
    return found;
  }

  Scratch scratch_;
  StoreAddress address_{scratch_.path("recorded.db")};
  std::optional<Store> store_;
  std::optional<Recorder> recorder_;
};

TEST_F(RecorderTest, TwoBusesBecomeTwoHistoriesWithTheirUnitsAndTypes) {
  start();
  recorder_->on_channel(channel("east", "p"));
  StationChannel text = channel("west", "name", "");
  text.type = "string(16)";
  recorder_->on_channel(text);
  recorder_->on_sample(sample_of("east", "p", 1, 1), utc(1));
  recorder_->on_sample(sample_of("west", "name", 1, 1, std::string("run")), utc(1));
  recorder_->on_sample(sample_of("east", "p", 2, 2, 2.5), utc(2));
  stop();
  const auto east = history(address_, "east");
  ASSERT_EQ(east.size(), 2u);
  EXPECT_EQ(east[1].value, Value(2.5));
  EXPECT_EQ(east[1].unit, "bar");
  EXPECT_EQ(east[1].type, "float32");
  EXPECT_EQ(east[1].published_at, utc(2));
  const auto west = history(address_, "west");
  ASSERT_EQ(west.size(), 1u);
  EXPECT_EQ(west[0].value, Value(std::string("run")));
  EXPECT_EQ(west[0].type, "string");
}

TEST_F(RecorderTest, TheLastValueThatComesAgainIsRecordedOnce) {
  start();
  recorder_->on_channel(channel("east", "p"));
  recorder_->on_sample(sample_of("east", "p", 1, 41), utc(1));
  recorder_->on_sample(sample_of("east", "p", 2, 42), utc(2));
  recorder_->on_gone("east", "d", "p");
  recorder_->on_channel(channel("east", "p"));
  recorder_->on_sample(sample_of("east", "p", 2, 42), utc(10));
  EXPECT_EQ(recorder_->counters().repeated, 1u);
  stop();
  EXPECT_THAT(sequences("east"), ElementsAre(41, 42));
}

TEST_F(RecorderTest, ARestartedRecorderKnowsWhatItsStoreHas) {
  StationSample stale = sample_of("east", "p", 1, 42);
  stale.quality = Quality::kBadNoResponse;
  start();
  recorder_->on_sample(sample_of("east", "p", 1, 41), utc(1));
  recorder_->on_sample(stale, utc(9));
  stop();
  start();
  recorder_->on_sample(stale, utc(30));  // has another arrival time
  recorder_->on_sample(sample_of("east", "p", 31, 43), utc(31));
  stop();
  EXPECT_THAT(sequences("east"), ElementsAre(41, 42, 43));
}

TEST_F(RecorderTest, ARestartedBridgeGoesOnInTheSameHistory) {
  start();
  recorder_->on_sample(sample_of("east", "p", 1, 41), utc(1));
  recorder_->on_gone("east", "d", "p");
  recorder_->on_sample(sample_of("east", "p", 5, 1), utc(5));
  recorder_->on_sample(sample_of("east", "p", 6, 2), utc(6));
  stop();
  EXPECT_THAT(sequences("east"), ElementsAre(41, 1, 2));
}

TEST_F(RecorderTest, AUnitThatChangesIsTheUnitFromThenOn) {
  start();
  recorder_->on_channel(channel("east", "p", "bar"));
  recorder_->on_sample(sample_of("east", "p", 1, 1), utc(1));
  ASSERT_TRUE(store_->flush(seconds{30}));
  recorder_->on_channel(channel("east", "p", "mbar"));
  recorder_->on_sample(sample_of("east", "p", 2, 2), utc(2));
  stop();
  EXPECT_EQ(history(address_, "east").at(0).unit, "mbar");
}

TEST_F(RecorderTest, OnlyWhatThePatternsNameIsRecorded) {
  StoreSpec spec = forever(address_);
  spec.samples = {"east/*/p*"};
  start(spec);
  for (const char* const name : {"p1", "q1", "p2"}) {
    recorder_->on_channel(channel("east", name));
    recorder_->on_sample(sample_of("east", name, 1, 1), utc(1));
  }
  EXPECT_EQ(recorder_->counters().recorded, 2u);
  stop();
  EXPECT_THAT(history(address_, "east").size(), 2);
}

TEST_F(RecorderTest, SamplesOfManyThreadsAllArriveInTheOrderOfTheirChannel) {
  constexpr int kThreads = 4;
  constexpr int kSamples = 5000;
  start();
  std::vector<std::thread> threads;
  for (int thread = 0; thread < kThreads; ++thread) {
    threads.emplace_back([this, bus = "bus" + std::to_string(thread)] {
      for (int i = 1; i <= kSamples; ++i)
        recorder_->on_sample(sample_of(bus, "p", i, static_cast<std::uint64_t>(i)), utc(i));
    });
  }
  for (auto& thread : threads) thread.join();
  EXPECT_EQ(recorder_->counters().recorded, std::uint64_t{kThreads * kSamples});
  stop();
  for (int thread = 0; thread < kThreads; ++thread) {
    const auto found = sequences("bus" + std::to_string(thread));
    ASSERT_EQ(found.size(), std::size_t{kSamples});
    EXPECT_TRUE(std::ranges::is_sorted(found));
  }
}

TEST_F(RecorderTest, MissingSamplesAreGapsAndFillThem) {
  const auto live = [](std::int64_t second, std::uint64_t sequence) {
    StationSample made = sample_of("east", "p", second, sequence);
    made.epoch = 7;
    return made;
  };
  const auto fetched = [](std::int64_t second, std::uint64_t sequence) {
    return HistoryRow{.number = {7, sequence},
                      .published_at = {utc(second).nanoseconds + 1},
                      .acquired_at = utc(second),
                      .value = 0.5,
                      .quality = Quality::kGood};
  };
  start();
  recorder_->watch_gaps();
  recorder_->on_sample(live(1, 4), utc(1));
  recorder_->on_sample(live(2, 5), utc(2));
  recorder_->on_sample(live(9, 12), utc(9));
  const Recorder::Gaps found = recorder_->take_gaps();
  ASSERT_EQ(found.first.size(), 1u);
  EXPECT_EQ(found.first[0].path, "east/d/p");
  EXPECT_EQ(found.first[0].number, (SampleNumber{7, 4}));
  EXPECT_EQ(found.first[0].published_at, utc(1));
  EXPECT_THAT(found.gaps, ElementsAre(Gap{"east/d/p", {7, 5}, {7, 12}, {}}));
  EXPECT_TRUE(recorder_->take_gaps().gaps.empty());
  for (std::uint64_t sequence = 5; sequence <= 12; ++sequence)  // the ends are repeated
    recorder_->on_fetched("east/d/p", fetched(static_cast<std::int64_t>(sequence) - 3, sequence));
  recorder_->on_fetched("east/d/unknown", fetched(5, 5));
  stop();
  EXPECT_THAT(sequences("east"), ElementsAre(4, 5, 6, 7, 8, 9, 10, 11, 12));
}

TEST_F(RecorderTest, ADeviceIsStoredWhenItsStateChanges) {
  const auto status = [](DeviceState state, std::int64_t second) {
    StationDeviceStatus made{.bus = "east", .device = "d", .reported_at = utc(second)};
    made.report.state = state;
    return made;
  };
  start();
  recorder_->on_device_status(status(DeviceState::kOnline, 1), utc(1));
  recorder_->on_device_status(status(DeviceState::kOnline, 2), utc(2));
  recorder_->on_device_status(status(DeviceState::kOffline, 3), utc(3));
  recorder_->on_device_status(status(DeviceState::kOffline, 4), utc(4));
  stop();
  start();
  recorder_->on_device_status(status(DeviceState::kOffline, 9), utc(9));  // no change
  stop();
  const auto connection = open_store(address_, IfMissing::kFail);
  const auto devices = EventTable(*connection).devices();
  ASSERT_EQ(devices.size(), 1u);
  EXPECT_EQ(devices[0].state, "offline");
  EXPECT_EQ(devices[0].since, utc(3));
}

TEST_F(RecorderTest, TheResponseTimeOfADeviceIsStoredOnceAMinute) {
  StationDeviceStatus status{
      .bus = "east", .device = "d", .report = {}, .causes = {}, .reported_at = {}};
  const auto report = [&](DeviceState state, std::int64_t second, Duration response) {
    status.report.state = state;
    status.report.response_time = response;
    status.reported_at = utc(second);
    recorder_->on_device_status(status, utc(second));
  };
  using std::chrono::microseconds;
  start();
  report(DeviceState::kUnknown, 60, {});
  for (std::int64_t second = 61; second < 240; ++second)
    report(DeviceState::kOnline, second, microseconds{4200 + second});
  report(DeviceState::kOffline, 280, microseconds{9000});
  stop();
  const auto rows = history(address_, "east/d/$response-time");
  ASSERT_EQ(rows.size(), 5u);  // minutes begin at 40, 100, 160 ...
  EXPECT_EQ(rows[0].unit, "ms");
  EXPECT_EQ(std::get<double>(rows[0].value), 4.261);
  EXPECT_EQ(rows[1].published_at, utc(100));
  EXPECT_EQ(rows[3].quality, Quality::kGood);
  EXPECT_EQ(rows[4].quality, Quality::kBadNoResponse);

  // A forged time does not leave the present.
  start();
  status.reported_at = utc(5'000'000'000);
  recorder_->on_device_status(status, utc(340));
  stop();
  EXPECT_EQ(history(address_, "east/d/$response-time").back().published_at, utc(340));
}

}  // namespace
}  // namespace fieldcast::web
