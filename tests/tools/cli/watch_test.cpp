#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tools/cli/model/sample_text.hpp"
#include "tools/cli/model/watch_model.hpp"
#include "tools/cli/view/station_view.hpp"

namespace fieldcast::cli {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr Instant kStart{};
constexpr UtcTime kUtc{1'700'000'000'000'000'000};

StationChannel channel(std::string device, std::string name, Duration refresh = 500ms) {
  StationChannel about;
  about.bus = "bus";
  about.device = std::move(device);
  about.channel = std::move(name);
  about.type = "int16";
  about.refresh = refresh;
  return about;
}

StationSample sample(std::string device, std::string name, Value value = std::int64_t{5},
                     Quality quality = Quality::kGood) {
  return {"bus", std::move(device), std::move(name), std::move(value), quality, 0, kUtc, 1};
}

TEST(WatchModel, KeepsTheNewestSampleOfEachMatchingChannel) {
  WatchModel model(Pattern::parse("bus/d1").value());
  EXPECT_TRUE(model.on_sample(sample("d1", "a", std::int64_t{1}), kStart));
  EXPECT_TRUE(model.on_sample(sample("d1", "a", std::int64_t{2}), kStart));
  EXPECT_FALSE(model.on_sample(sample("d2", "a"), kStart));
  ASSERT_EQ(model.rows().size(), 1u);
  EXPECT_EQ(model.rows().begin()->second.sample.value, Value{std::int64_t{2}});
  EXPECT_EQ(model.summary(), "2 samples of 1 channel, 1 of them GOOD");
}

TEST(WatchModel, AwaitsChannelsThatPromiseSamplesOnly) {
  WatchModel model({});
  model.on_channel(channel("d", "promised"));
  model.on_channel(channel("d", "on-demand", 0ns));
  EXPECT_EQ(model.awaited(), 1u);
  EXPECT_EQ(model.awaited(true), 2u);
  model.on_sample(sample("d", "promised", false, Quality::kNotYetRead), kStart);
  EXPECT_EQ(model.awaited(), 1u);
  EXPECT_EQ(model.awaited(true), 2u);
  model.on_sample(sample("d", "promised", false, Quality::kBadNoResponse),
                  kStart);  // a bad value counts too
  EXPECT_EQ(model.awaited(), 0u);
}

TEST(WatchModel, AnInterestThatChangesNothingIsRemarked) {
  WatchModel model(Pattern::parse("bus/d").value());
  EXPECT_THAT(model.interest_remark(200ms).value_or(""),
              HasSubstr("the interest in bus/d/* meets nothing"));
  model.on_channel(channel("d", "granted", 200ms));
  model.on_channel(channel("d", "faster than asked for", 100ms));
  model.on_channel(channel("other", "not ours", 1s));
  EXPECT_FALSE(model.interest_remark(200ms));
  model.on_channel(channel("d", "read anyway", 1s));
  EXPECT_EQ(model.interest_remark(200ms),
            "the interest in bus/d/* every 200ms changes nothing for 1 of 3 channels: 1 are read "
            "anyway, less often (acquire: always)");
  model.on_channel(channel("d", "on demand", 0s));
  EXPECT_THAT(model.interest_remark(200ms).value_or(""), HasSubstr("for 2 of 4 channels"));
  EXPECT_THAT(model.interest_remark(200ms).value_or(""), HasSubstr("1 are not read by themselves"));
}

TEST(WatchModel, ARemovedChannelIsNoLongerGoodUntilItIsBack) {
  WatchModel model({});
  model.on_sample(sample("d", "a"), kStart);
  EXPECT_FALSE(model.is_gone({"bus", "d", "a"}));
  EXPECT_TRUE(model.on_gone({"bus", "d", "a"}));
  EXPECT_FALSE(model.on_gone({"bus", "d", "a"})) << "it was gone";
  EXPECT_FALSE(model.on_gone({"bus", "d", "b"})) << "it was never there";
  EXPECT_TRUE(model.is_gone({"bus", "d", "a"}));
  EXPECT_EQ(model.good(), 0u);
  EXPECT_THAT(watch_lines(model, kStart, kUtc, {}).at(2), HasSubstr("GONE"));
  model.on_sample(sample("d", "a"), kStart);
  EXPECT_EQ(model.good(), 1u);
  EXPECT_FALSE(model.is_gone({"bus", "d", "a"}));
}

TEST(WatchModel, TheLinesOfAChannelThatIsGone) {
  const ChannelPath path{"bus", "d", "a"};
  EXPECT_EQ(gone_line(path, kUtc), "2023-11-14T22:13:20.000Z  bus/d/a  -  GONE");
  EXPECT_EQ(gone_json(path).text(),
            R"({"event":"no_bridge","bus":"bus","device":"d","channel":"a"})");
}

TEST(RateMeter, FollowsWhatComes) {
  RateMeter meter;
  EXPECT_EQ(meter.rate(kStart), 0);
  meter.count(kStart - 1s);
  meter.count(kStart - 500ms);
  EXPECT_NEAR(meter.rate(kStart - 500ms), 2, 1e-9);
  for (int i = 0; i < 40; ++i) meter.count(kStart + i * 100ms);
  EXPECT_NEAR(meter.rate(kStart + 4s), 10, 0.6);
  EXPECT_LT(meter.rate(kStart + 60s), 1);
}

TEST(WatchView, ShowsValueUnitQualityAgeAndRefresh) {
  WatchModel model({});
  auto about = channel("d", "a");
  about.unit = "bar";
  model.on_channel(about);
  model.on_sample(sample("d", "a", 2.5), kStart);
  const auto lines = watch_lines(model, kStart, UtcTime{kUtc.nanoseconds + 250'000'000}, {});
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_THAT(lines[0], HasSubstr("1 sample of 1 channel, 1 of them GOOD"));
  EXPECT_THAT(lines[2], testing::MatchesRegex("bus/d/a +2.5 +bar +GOOD +0.25 s +500ms +0.0/s"));
}

TEST(WatchView, NeverHasMoreLinesThanTheScreen) {
  WatchModel model({});
  for (int i = 0; i < 30; ++i) model.on_sample(sample("d", "c" + std::to_string(i)), kStart);
  for (std::size_t rows = 5; rows < 40; ++rows) {
    const auto lines = watch_lines(model, kStart, kUtc, {60, rows, false});
    EXPECT_LE(lines.size(), rows);
    for (const auto& line : lines) EXPECT_LE(display_width(line), 60u);
    if (rows < 32) {
      EXPECT_THAT(lines.back(), HasSubstr("and " + std::to_string(30 - (rows - 3)) + " more"));
    }
  }
}

TEST(WatchView, AStationThatIsTooSlowSaysSoInItsLastLine) {
  WatchModel model({});
  model.on_sample(sample("d", "a"), kStart);
  EXPECT_FALSE(model.lag_remark());
  model.on_counters({.blocks = 100, .missing = 12, .requests = 3});
  const std::string lag =
      "this station is too slow: 12 blocks missed, last values asked for again 3 times";
  EXPECT_EQ(watch_lines(model, kStart, kUtc, {}).back(), lag);
  for (int i = 0; i < 20; ++i) model.on_sample(sample("d", std::to_string(i)), kStart);
  const auto lines = watch_lines(model, kStart, kUtc, {.columns = 40, .rows = 10});
  EXPECT_EQ(lines.size(), 10u);
  EXPECT_EQ(lines.back(), lag.substr(0, 40));
}

TEST(WatchView, TheEventOfAStationThatIsTooSlowIsNotASample) {
  EXPECT_EQ(lag_json({.blocks = 100, .missing = 12, .requests = 3}).text(),
            R"({"event":"too_slow","blocks_missed":12,"last_values_requests":3})");
}

TEST(WatchView, HostileTextDoesNotReachTheTerminal) {
  WatchModel model({});
  model.on_sample(sample("d", "a", std::string("\x1b]0;owned\x07")), kStart);
  for (const auto& line : watch_lines(model, kStart, kUtc, {}))
    EXPECT_EQ(line.find('\x1b'), std::string::npos);
}

}  // namespace
}  // namespace fieldcast::cli
