#include <gtest/gtest.h>

#include <map>
#include <random>

#include "core/dispatch/plan_runner.hpp"
#include "core/dispatch/policy/dispatch_state.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

Instant at(std::uint64_t nanoseconds) {
  return Instant{Duration{static_cast<Duration::rep>(nanoseconds)}};
}

TEST(DueQueue, TheTopIsTheSmallestWhateverIsPutMovedAndTakenOut) {
  constexpr std::uint32_t kIds = 50;
  std::mt19937_64 random(1);
  DueQueue queue(kIds);
  std::map<std::uint32_t, Instant> expected;
  for (int step = 0; step < 20'000; ++step) {
    const auto id = static_cast<std::uint32_t>(random() % kIds);
    if (random() % 3 == 0) {
      queue.remove(id);
      expected.erase(id);
    } else {
      const Instant key = at(random() % 1000);
      queue.put(id, key);
      expected[id] = key;
    }
    ASSERT_EQ(queue.size(), expected.size());
    ASSERT_EQ(queue.holds(id), expected.contains(id));
    if (expected.empty()) continue;
    Instant least = kNever;
    for (const auto& [each, key] : expected) least = std::min(least, key);
    ASSERT_EQ(queue.top_key(), least);
    ASSERT_EQ(expected[queue.top()], least);
  }
}

TEST(LinePace, IsThatOfTheSlowestOfTheLastReads) {
  LinePace pace;
  EXPECT_EQ(pace.of(100ns), 100ns);
  for (int i = 0; i < 32; ++i) pace.read(20ns, 100ns);
  EXPECT_EQ(pace.of(100ns), 20ns);
  pace.read(80ns, 100ns);
  EXPECT_EQ(pace.of(100ns), 80ns) << "a slow one counts at once";
  pace.read(500ns, 100ns);
  EXPECT_EQ(pace.of(100ns), 100ns) << "a retry is no pace of the line";
  for (int i = 0; i < 32; ++i) pace.read(95ns, 100ns);
  EXPECT_EQ(pace.of(100ns), 100ns) << "nor is a small difference";
}

// Adds 256 acquisitions from `now` on, one per millisecond, with every `late_each`-th late.
void window(OverrunWatch& watch, Instant& now, int late_each, bool rests = false) {
  for (int i = 0; i < 256; ++i) {
    watch.wire_free(now, rests);
    now += 1ms;
    watch.wire_free(now, false);
    watch.acquired(late_each != 0 && i % late_each == 0, now);
  }
}

TEST(OverrunWatch, LatePointsOnAWireThatNeverRestsAreOverrun) {
  OverrunWatch watch;
  Instant now{1s};
  window(watch, now, 0);
  EXPECT_EQ(watch.overrun(), 1);
  window(watch, now, 5);
  EXPECT_DOUBLE_EQ(watch.overrun(), 1.05);
  window(watch, now, 50);
  EXPECT_DOUBLE_EQ(watch.overrun(), 1.05) << "few";
  window(watch, now, 0);
  EXPECT_LT(watch.overrun(), 1.05) << "none: it fades";
}

TEST(OverrunWatch, AWireThatRestsIsNotOverrun) {
  OverrunWatch watch;
  Instant now{1s};
  window(watch, now, 2, true);
  EXPECT_EQ(watch.overrun(), 1);
}

TEST(OverrunWatch, WhatIsLateInTheFirstRoundOfAPlanDoesNotCount) {
  OverrunWatch watch;
  Instant now{1s};
  watch.plan_began(now + 10s);
  window(watch, now, 2);
  EXPECT_EQ(watch.overrun(), 1);
}

TEST(OverrunWatch, HasALimit) {
  OverrunWatch watch;
  Instant now{1s};
  for (int i = 0; i < 200; ++i) window(watch, now, 2);
  EXPECT_EQ(watch.overrun(), 16);
}

}  // namespace
}  // namespace fieldcast
