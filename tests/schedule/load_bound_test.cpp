#include "core/schedule/load_bound.hpp"

#include <gtest/gtest.h>

#include "core/dispatch/scheduler.hpp"
#include "core/protocol/families/registry.hpp"
#include "tests/plan/maps.hpp"

namespace fieldcast {
namespace {

using test::kFakeProtocol;

constexpr std::uint32_t kBaud = 19200;

ScheduleInput bus(std::uint64_t seed, std::size_t channels = 60, double stretch = 20) {
  return test::input_of(test::random_map(seed, channels), kFakeProtocol, kBaud, {}, stretch);
}

Duration wire_time_of(const ScheduleInput& input, std::uint32_t items) {
  const ReadCost cost(input.devices[0], test::kRegisters, input.line, input.silence, items);
  return cost.of({test::kRegisters, 0, items});
}

TEST(LoadBound, OnePointNeedsOneReadInEachRefresh) {
  const ScheduleInput input = test::input_of({{1, 0, 1.0}}, kFakeProtocol);
  const auto bound = load_bound_of(input);
  ASSERT_TRUE(bound);
  EXPECT_EQ(bound->prices, std::vector{wire_time_of(input, 1)});
  EXPECT_NEAR(bound->load, to_seconds(wire_time_of(input, 1)), 1e-9);
}

TEST(LoadBound, ASlowNeighbourPaysOnlyForItsItems) {
  const ScheduleInput input = test::input_of({{1, 0, 1.0}, {1, 1, 10.0}}, kFakeProtocol);
  const auto bound = load_bound_of(input);
  ASSERT_TRUE(bound);
  EXPECT_EQ(bound->prices[1], wire_time_of(input, 2) - wire_time_of(input, 1));
}

// The refresh is a promise in both modes; on demand nothing is promised.
TEST(LoadBound, AnIntensivePointPaysAsAScheduledOne) {
  ScheduleInput input = test::input_of({{1, 0, 1.0}, {1, 500, 0.1}}, kFakeProtocol);
  const auto scheduled = load_bound_of(input);
  ASSERT_TRUE(scheduled);
  input.points[1].mode = Mode::kIntensive;
  EXPECT_EQ(load_bound_of(input)->load, scheduled->load);
  input.points[1].mode = Mode::kOnDemand;
  EXPECT_NEAR(load_bound_of(input)->load, scheduled->load / 11, 1e-9);
}

TEST(LoadBound, EqualsTheBoundOfClasses) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto bound = load_bound_of(bus(seed, 60, 1));
    ASSERT_TRUE(bound) << seed;
    const double classes = test::proven_load(test::random_map(seed, 60), kBaud);
    EXPECT_NEAR(bound->load, classes, 0.001 * classes) << seed;
  }
}

TEST(LoadBound, NoPlanNeedsLess) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const ScheduleInput input = bus(seed);
    const auto scheduler = make_scheduler(input);
    ASSERT_EQ(scheduler->stretch(), 1) << seed;
    EXPECT_LT(load_bound_of(input)->load, scheduler->plan().table->load()) << seed;
  }
}

// Devices with small limits, where the cheapest requests are not submodular.
TEST(LoadBound, IsProvenUnderEveryLimit) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    ScheduleInput input = bus(seed);
    for (DeviceTiming& device : input.devices)
      device.max_block = static_cast<std::uint16_t>(2 + seed);
    const auto bound = load_bound_of(input);
    ASSERT_TRUE(bound) << seed;
    EXPECT_EQ(proven_load(input, bound->prices), bound->load) << seed;
    EXPECT_GT(bound->load, 0.5 * test::proven_load(test::random_map(seed, 60), kBaud) / 20) << seed;
  }
}

TEST(LoadBound, APriceAboveTheRequestForThePointProvesNothing) {
  const ScheduleInput input = bus(5);
  for (PointIndex point = 0; point < input.points.size(); ++point) {
    std::vector<Duration> prices(input.points.size());
    prices[point] = wire_time_of(input, 1);
    EXPECT_TRUE(proven_load(input, prices)) << point;
    ++prices[point];
    EXPECT_FALSE(proven_load(input, prices)) << point;
  }
}

TEST(LoadBound, TooMuchForTwoNeighboursTogetherProvesNothing) {
  const ScheduleInput input = test::input_of({{1, 0, 1.0}, {1, 1, 1.0}}, kFakeProtocol);
  const Duration one = wire_time_of(input, 1), two = wire_time_of(input, 2);
  EXPECT_TRUE(proven_load(input, std::vector{one, two - one}));
  EXPECT_FALSE(proven_load(input, std::vector{one, two - one + Duration{1}}));
  EXPECT_FALSE(proven_load(input, std::vector{one, one})) << "each alone is right";
}

TEST(LoadBound, NegativeAndMissingPricesProveNothing) {
  const ScheduleInput input = test::input_of({{1, 0, 1.0}, {1, 1, 1.0}}, kFakeProtocol);
  EXPECT_FALSE(proven_load(input, std::vector{Duration{5}, Duration{-1}}));
  EXPECT_FALSE(proven_load(input, std::vector{Duration{5}}));
}

TEST(LoadBound, IsNotKnownForListsOfRanges) {
  const auto protocol = *find_protocol("s7-ppi")->make({.address = 2, .options = {}, .line = {}});
  ScheduleInput input = bus(1, 3);
  for (DeviceTiming& device : input.devices) device.protocol = protocol.get();
  EXPECT_FALSE(load_bound_of(input));
  EXPECT_FALSE(proven_load(input, std::vector<Duration>(input.points.size())));
}

TEST(LoadBound, IsNotSearchedForThousandsOfPoints) {
  test::Map map;
  for (std::uint32_t i = 0; i < 2001; ++i) map.push_back({1, i, 1.0});
  EXPECT_FALSE(load_bound_of(test::input_of(map, kFakeProtocol)));
}

}  // namespace
}  // namespace fieldcast
