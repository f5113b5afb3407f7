#include "bridge/configure/watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace fieldcast::configure {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr Instant kStart{1h};

Watch watching() {
  Watch watch{.version = "new", .base = "old", .until = kStart + 2min, .good = {"l/d/a", "l/d/b"}};
  (void)reloaded(watch, "", kStart);
  return watch;
}

TEST(Watch, BeginsWithTheReloadAndLastsThirtySeconds) {
  const Watch watch = watching();
  EXPECT_EQ(watch.state, Watch::State::kWatching);
  EXPECT_EQ(watch.until, kStart + 30s);
  const ChannelQualities bad{{"l/d/a", Quality::kBadNoResponse}};
  EXPECT_EQ(looked(watch, bad, kStart + 29s).end, WatchEnd::kNone);
  EXPECT_EQ(looked(watch, bad, kStart + 30s).end, WatchEnd::kRollBack);
}

TEST(Watch, KeepsAVersionWithoutWorseChannels) {
  const ChannelQualities fine{
      {"l/d/a", Quality::kGood}, {"l/d/b", Quality::kUncertain}, {"l/d/new", Quality::kBadFrame}};
  EXPECT_EQ(looked(watching(), fine, kStart + 30s).end, WatchEnd::kKeep);
}

TEST(Watch, ARemovedChannelIsNotWorse) {
  EXPECT_THAT(worse_channels(watching(), {{"l/d/a", Quality::kGood}}), IsEmpty());
}

TEST(Watch, NamesTheWorseChannels) {
  const ChannelQualities now{{"l/d/a", Quality::kBadNoResponse}, {"l/d/b", Quality::kNotYetRead}};
  EXPECT_THAT(worse_channels(watching(), now),
              ElementsAre("l/d/a BAD_NO_ANSWER", "l/d/b NOT_YET_READ"));
  EXPECT_THAT(looked(watching(), now, kStart + 30s).reason, HasSubstr("l/d/a BAD_NO_ANSWER"));
}

TEST(Watch, ARefusedReloadRollsBackImmediately) {
  Watch watch{.version = "new", .until = kStart + 2min};
  const WatchStep step = reloaded(watch, "no such interface", kStart);
  EXPECT_EQ(step.end, WatchEnd::kRollBack);
  EXPECT_THAT(step.reason, HasSubstr("no such interface"));
}

TEST(Watch, AReloadThatNeverEndsRollsBack) {
  const Watch watch{.version = "new", .until = kStart + 2min};
  EXPECT_EQ(looked(watch, {}, kStart + 119s).end, WatchEnd::kNone);
  EXPECT_EQ(looked(watch, {}, kStart + 2min).end, WatchEnd::kRollBack);
}

TEST(Watch, ALaterReloadDoesNotChangeIt) {
  Watch watch = watching();
  EXPECT_EQ(reloaded(watch, "a fault of another file", kStart + 5s).end, WatchEnd::kNone);
  EXPECT_EQ(watch.until, kStart + 30s);
}

TEST(Watch, OneRestartContinuesItAndTheSecondEndsIt) {
  Watch watch = watching();
  EXPECT_EQ(restarted(watch, true, kStart + 10s).end, WatchEnd::kNone);
  EXPECT_EQ(watch.until, kStart + 40s);
  EXPECT_EQ(restarted(watch, true, kStart + 20s).end, WatchEnd::kRollBack);
}

TEST(Watch, ARestartWithAnInvalidFileEndsIt) {
  Watch watch = watching();
  EXPECT_EQ(restarted(watch, false, kStart).end, WatchEnd::kRollBack);
}

TEST(Watch, OnlyGoodChannelsAreRemembered) {
  EXPECT_THAT(
      good_channels({{"a", Quality::kGood}, {"b", Quality::kUncertain}, {"c", Quality::kBadFrame}}),
      ElementsAre("a"));
}

}  // namespace
}  // namespace fieldcast::configure
