#include <gtest/gtest.h>

#include <algorithm>

#include "core/bus/bus_engine.hpp"
#include "tests/bus/rtu_bus.hpp"

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

bool sends(BusEngine& engine, const BusEvent& event, Instant now) {
  Actions actions;
  engine.on_event(event, now, actions);
  make_plans(engine, now, actions);
  return std::ranges::any_of(
      actions, [](const Action& action) { return std::holds_alternative<Send>(action); });
}

TEST(Successor, WaitsAsLongAsItsPredecessorSaysAnswersMayCome) {
  const BusSpec spec = rtu_bus(1);
  BusEngine before(spec);
  Instant now{10s};
  (void)sends(before, Opened{}, now);
  EXPECT_EQ(before.answers_until(), kLongAgo);
  while (!sends(before, TimerFired{}, now)) now += 1ms;
  (void)sends(before, StopRequested{}, now);
  const Instant until = before.answers_until();
  EXPECT_GE(until, now + PendingResponses::kLateFactor * spec.devices[0].timeout);

  BusEngine after(spec);
  EXPECT_FALSE(sends(after, Opened{until}, now));
  for (; now < until; now += 1ms) EXPECT_FALSE(sends(after, TimerFired{}, now));
  bool sent = false;
  for (int i = 0; i < 100 && !sent; ++i) sent = sends(after, TimerFired{}, now += 1ms);
  EXPECT_TRUE(sent);
}

TEST(Successor, WaitsForNothingWhereNothingWasAsked) {
  BusEngine before(rtu_bus(1));
  (void)sends(before, Opened{}, Instant{10s});
  (void)sends(before, StopRequested{}, Instant{10s} + 1us);
  EXPECT_EQ(before.answers_until(), kLongAgo);
}

}  // namespace
}  // namespace fieldcast::test
