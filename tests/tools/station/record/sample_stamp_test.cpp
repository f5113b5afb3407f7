#include <gtest/gtest.h>

#include "tools/station/record/recorder.hpp"

namespace fieldcast::web {
namespace {

using namespace std::chrono_literals;

UtcTime at(double second) {
  return {1'700'000'000'000'000'000 + static_cast<std::int64_t>(second * 1e9)};
}

StationSample reading(double acquired, std::uint64_t sequence, Quality quality = Quality::kGood) {
  return {.quality = quality, .acquired_at = at(acquired), .sequence = sequence};
}

TEST(SampleStamp, AGoodSampleCountsFromItsAcquisition) {
  SampleStamp stamp;
  EXPECT_EQ(stamp.next(reading(1, 1), at(1.2), 0ns, true), at(1));
  EXPECT_EQ(stamp.next(reading(2, 2), at(2.2), 0ns, false), at(2));
}

TEST(SampleStamp, TheSameSampleOnceMoreIsNone) {
  SampleStamp stamp;
  EXPECT_TRUE(stamp.next(reading(1, 7), at(1.2), 0ns, true));
  EXPECT_FALSE(stamp.next(reading(1, 7), at(9), 0ns, true));
  EXPECT_TRUE(stamp.next(reading(1, 8, Quality::kBadNoResponse), at(9), 0ns, false));
}

TEST(SampleStamp, ASequenceThatRestartsIsNotARepetition) {
  SampleStamp stamp;
  EXPECT_TRUE(stamp.next(reading(1, 7), at(1.2), 0ns, true));
  EXPECT_EQ(stamp.next(reading(5, 1), at(5.1), 0ns, true), at(5)) << "its bridge was restarted";
  EXPECT_EQ(stamp.next(reading(6, 7), at(6.1), 0ns, false), at(6));
}

TEST(SampleStamp, ABadSampleCountsFromItsArrivalByTheClockOfItsBridge) {
  SampleStamp stamp;
  EXPECT_EQ(stamp.next(reading(1, 1, Quality::kBadNoResponse), at(31.2), 30s, true), at(1.2));
}

TEST(SampleStamp, OrderIsKeptWhereADelayOnTheWayWouldTurnItRound) {
  SampleStamp stamp;
  EXPECT_EQ(stamp.next(reading(1, 1, Quality::kBadNoResponse), at(5.5), 0ns, true), at(5.5));
  EXPECT_EQ(stamp.next(reading(5.4, 2), at(5.6), 0ns, false), (UtcTime{at(5.5).nanoseconds + 1}));
  EXPECT_EQ(stamp.next(reading(6, 3), at(6.1), 0ns, false), at(6));
}

TEST(SampleStamp, AClockThatIsSetBackDoesNotHoldUpTheHistory) {
  SampleStamp stamp;
  EXPECT_EQ(stamp.next(reading(100, 1), at(100), 0ns, true), at(100));
  EXPECT_EQ(stamp.next(reading(40, 2), at(101), 0ns, false), at(40));
}

TEST(SampleStamp, TheLastValueOfARarelyReadChannelCountsFromItsAcquisition) {
  SampleStamp stamp;
  EXPECT_EQ(stamp.next(reading(0, 1), at(3600), 0ns, true), at(0));
  SampleStamp old;
  EXPECT_EQ(old.next(reading(0, 1), at(25 * 3600), 0ns, true), at(25 * 3600));
}

TEST(SampleStamp, AClockThatIsWrongIsNotBelieved) {
  SampleStamp stamp;
  EXPECT_TRUE(stamp.next(reading(0, 1), at(1), 0ns, true));
  EXPECT_EQ(stamp.next(reading(5000, 2), at(2), 0ns, false), at(2)) << "from the future";
  EXPECT_EQ(stamp.next(reading(-5000, 3), at(3), 0ns, false), at(3)) << "from the past";
}

// Any participant in the domain can publish such times.
TEST(SampleStamp, TimesAtTheEndsOf64BitsAreNotBelieved) {
  for (const std::int64_t end : {INT64_MIN, INT64_MAX}) {
    SampleStamp stamp;
    EXPECT_EQ(stamp.next({.quality = Quality::kGood, .acquired_at = {end}, .sequence = 1}, at(1),
                         0ns, true),
              at(1));
    ClockOffset clock;
    clock.note({end}, at(1));
    EXPECT_EQ(clock.least(), 0ns);
    clock.note({end}, {0});
    EXPECT_EQ(clock.least(), 0ns);
  }
}

TEST(SampleStamp, AClockOfThisMachineAtTheEndOf64BitsDoesNotWrap) {
  SampleStamp stamp;
  const StationSample bad{.quality = Quality::kBadNoResponse, .acquired_at = {}, .sequence = 1};
  EXPECT_EQ(stamp.next(bad, {INT64_MAX}, -10s, true), UtcTime{INT64_MAX});
  EXPECT_EQ(stamp.next({.sequence = 2}, {INT64_MAX}, 0ns, false), UtcTime{INT64_MAX});
}

TEST(ClockOffset, IsTheLeastOfAboutAMinute) {
  ClockOffset clock;
  EXPECT_EQ(clock.least(), 0ns);
  clock.note(at(0), at(0.5));
  clock.note(at(1), at(1.25));
  clock.note(at(2), at(2.75));
  EXPECT_EQ(clock.least(), 250ms);
  clock.note(at(62), at(62.5));
  EXPECT_EQ(clock.least(), 250ms) << "the window before counts too";
  clock.note(at(123), at(123.5));
  EXPECT_EQ(clock.least(), 500ms);
}

TEST(ClockOffset, MayBeNegative) {
  ClockOffset clock;
  clock.note(at(10), at(7));
  EXPECT_EQ(clock.least(), -3s);
}

TEST(ClockOffset, AClockThatIsWrongCountsForNothing) {
  ClockOffset clock;
  clock.note(at(0), at(5000));
  clock.note(at(9000), at(5001));
  EXPECT_EQ(clock.least(), 0ns);
}

}  // namespace
}  // namespace fieldcast::web
