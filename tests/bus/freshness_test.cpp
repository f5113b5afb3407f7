#include "core/bus/command/freshness.hpp"

#include <gtest/gtest.h>

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using State = Freshness::State;

class FreshnessTest : public testing::Test {
 protected:
  Freshness read_at_zero() {
    Freshness fresh(1s, 1s);
    fresh.acquired(Instant{}, misses_);
    return fresh;
  }
  Freshness missed() {
    Freshness fresh = read_at_zero();
    EXPECT_TRUE(fresh.expire(fresh.due(), misses_));
    return fresh;
  }
  CauseCounters misses_;
};

TEST_F(FreshnessTest, AMissIsReportedAMomentAfterThePromiseBroke) {
  Freshness fresh = read_at_zero();
  EXPECT_EQ(fresh.state(), State::kInTime);
  EXPECT_EQ(fresh.due(), Instant{1s} + Freshness::kTellAfter);
  EXPECT_TRUE(fresh.expire(fresh.due(), misses_));
  EXPECT_EQ(fresh.state(), State::kMissed);
  EXPECT_EQ(fresh.due(), kNever);
  EXPECT_EQ(misses_[Cause::kLate], 1u);
}

TEST_F(FreshnessTest, AMissWithACauseIsReportedOnce) {
  Freshness fresh = read_at_zero();
  EXPECT_FALSE(fresh.failing(Cause::kNoResponse, false, Instant{500ms})) << "in time until then";
  EXPECT_TRUE(fresh.expire(fresh.due(), misses_));
  EXPECT_EQ(fresh.state(), State::kTold);
  EXPECT_FALSE(fresh.failing(Cause::kChecksum, false, Instant{2s}));
  EXPECT_EQ(fresh.due(), kNever);
  EXPECT_EQ(misses_[Cause::kNoResponse], 1u);
  EXPECT_EQ(misses_.total(), 1u);
}

TEST_F(FreshnessTest, ACauseThatBecomesKnownTakesOverTheMiss) {
  Freshness fresh = missed();
  EXPECT_TRUE(fresh.failing(Cause::kNoResponse, true, Instant{1500ms}));
  EXPECT_EQ(fresh.state(), State::kMissedExplained);
  EXPECT_EQ(fresh.due(), Instant{1500ms});
  EXPECT_TRUE(fresh.expire(Instant{1500ms}, misses_));
  EXPECT_EQ(fresh.state(), State::kTold);
  EXPECT_EQ(misses_[Cause::kLate], 0u);
  EXPECT_EQ(misses_[Cause::kNoResponse], 1u);
  EXPECT_EQ(fresh.last_miss(), Cause::kNoResponse);
}

TEST_F(FreshnessTest, ACauseAfterALeaseIsReportedAndTakesOverNothing) {
  Freshness fresh = read_at_zero();
  fresh.leased(true, Instant{500ms}, misses_);
  EXPECT_EQ(fresh.state(), State::kTold);
  EXPECT_TRUE(fresh.failing(Cause::kNoResponse, true, Instant{800ms}));
  EXPECT_EQ(fresh.state(), State::kToldExplained);
  EXPECT_TRUE(fresh.expire(Instant{800ms}, misses_));
  EXPECT_EQ(fresh.state(), State::kTold);
  EXPECT_EQ(misses_.total(), 0u);
}

TEST_F(FreshnessTest, ARefusalThatWasReportedMakesTheMissNoNews) {
  Freshness fresh = read_at_zero();
  fresh.refused(Cause::kDeviceError, Instant{200ms}, misses_);
  EXPECT_EQ(fresh.state(), State::kTold);
  EXPECT_FALSE(fresh.expire(Instant{2s}, misses_));
  EXPECT_EQ(fresh.missed(Instant{2200ms}), 2u) << "counted all the same";
}

TEST_F(FreshnessTest, EveryRefreshThatPassesIsAMiss) {
  Freshness fresh = missed();
  CauseCounters all = misses_;
  fresh.add_passed(Instant{5500ms}, all);
  EXPECT_EQ(all[Cause::kLate], 5u);
  EXPECT_EQ(fresh.missed(Instant{5500ms}), 5u);
  fresh.acquired(Instant{5500ms}, misses_);
  EXPECT_EQ(misses_[Cause::kLate], 5u);
  EXPECT_EQ(fresh.missed(Instant{6400ms}), 5u);
  EXPECT_EQ(fresh.state(), State::kInTime);
}

TEST_F(FreshnessTest, ASampleBetweenThePromiseAndItsTellingIsAMiss) {
  Freshness fresh = read_at_zero();
  fresh.acquired(Instant{1001ms}, misses_);
  EXPECT_EQ(misses_[Cause::kLate], 1u);
  EXPECT_EQ(fresh.state(), State::kInTime);
}

TEST_F(FreshnessTest, ALongerGapIsCountedByItself) {
  Freshness fresh(1s, 4s);
  fresh.acquired(Instant{}, misses_);
  ASSERT_TRUE(fresh.expire(fresh.due(), misses_));
  EXPECT_EQ(fresh.missed(Instant{9s}), 2u);
}

TEST_F(FreshnessTest, WithoutAPromiseNothingIsMissed) {
  Freshness fresh = missed();
  fresh.promise(std::nullopt, 0s, Instant{3500ms}, misses_);
  EXPECT_EQ(fresh.due(), kNever);
  EXPECT_EQ(fresh.missed(Instant{100s}), 3u) << "until the promise ended";
  EXPECT_EQ(fresh.state(), State::kInTime);
}

TEST_F(FreshnessTest, ANewStartDoesNotForgiveAMissThatWasReported) {
  Freshness fresh = missed();
  fresh.start(Instant{2s});
  EXPECT_EQ(fresh.state(), State::kMissed);
  EXPECT_EQ(fresh.due(), kNever);
  Freshness in_time = read_at_zero();
  in_time.start(Instant{500ms});
  EXPECT_EQ(in_time.due(), Instant{1500ms} + Freshness::kTellAfter);
}

}  // namespace
}  // namespace fieldcast
