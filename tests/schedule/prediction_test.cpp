#include "core/schedule/prediction.hpp"

#include <gtest/gtest.h>

#include "tests/dispatch/virtual_wire.hpp"
#include "tests/plan/maps.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

using test::kFakeProtocol;

test::Map two_groups() {
  test::Map map;
  for (std::uint32_t i = 0; i < 5; ++i) map.push_back({1, 2 * i, 0.5});
  for (std::uint32_t i = 0; i < 5; ++i) map.push_back({2, 2 * i, 2.0});
  return map;
}

TEST(Prediction, LightPlanIsFeasibleAndItsLoadIsWhatTheBlocksCost) {
  const ScheduleInput input = test::input_of(two_groups(), kFakeProtocol);
  const Prediction prediction = predict(input);
  EXPECT_TRUE(prediction.feasible);
  EXPECT_EQ(prediction.stretch, 1.0);
  EXPECT_EQ(prediction.missed, 0u);
  EXPECT_GE(prediction.horizon, 60s);
  ASSERT_EQ(prediction.blocks.size(), 2u);
  double load = 0;
  for (const BlockForecast& block : prediction.blocks)
    load += block.per_second * to_seconds(block.cost);
  EXPECT_NEAR(load, prediction.load, 1e-6);
  EXPECT_NEAR(prediction.load, prediction.planned_load, 0.05 * prediction.planned_load);
  for (const PointForecast& point : prediction.points) {
    EXPECT_LE(point.worst_gap, point.refresh);
    EXPECT_GT(point.reads, 0u);
  }
  EXPECT_FALSE(prediction.remedies.stretch || prediction.remedies.baud ||
               !prediction.remedies.slower.empty());
}

TEST(Prediction, OverloadNamesConfigurationsThatWork) {
  const ScheduleInput input = test::input_of(test::random_map(2, 100), kFakeProtocol);
  const Prediction prediction = predict(input);
  ASSERT_FALSE(prediction.feasible);
  EXPECT_GT(prediction.planned_load, 1.0);
  EXPECT_GT(prediction.missed, 0u);

  ASSERT_TRUE(prediction.remedies.stretch);
  ScheduleInput slower = input;
  for (Point& point : slower.points)
    point.refresh = from_seconds(to_seconds(point.refresh) * *prediction.remedies.stretch);
  EXPECT_TRUE(predict(slower).feasible);

  ASSERT_TRUE(prediction.remedies.baud);
  EXPECT_GT(*prediction.remedies.baud, input.line.baud);

  ASSERT_FALSE(prediction.remedies.slower.empty());
  ScheduleInput some = input;
  for (const SlowerPoints& group : prediction.remedies.slower) {
    for (const PointIndex point : group.points) {
      EXPECT_EQ(some.points[point].refresh, group.from);
      some.points[point].refresh = group.to;
    }
  }
  EXPECT_TRUE(predict(some).feasible);
}

TEST(Prediction, DevicesAreSpreadOverLinesThatEachWork) {
  ScheduleInput input = test::input_of(two_groups(), kFakeProtocol);
  const DeviceTiming device = input.devices.front();
  input.devices.assign(6, device);
  input.points.clear();
  for (DeviceIndex d = 0; d < 6; ++d)
    input.points.push_back({.device = d, .range = {0, 0, 1}, .refresh = 55ms});
  const Prediction prediction = predict(input);
  ASSERT_FALSE(prediction.feasible);
  ASSERT_TRUE(prediction.remedies.buses);
  const std::size_t lines = *prediction.remedies.buses;
  EXPECT_GE(lines, 2u);
  ScheduleInput fullest = input;
  std::erase_if(fullest.points,
                [&](const Point& point) { return point.device >= (6 + lines - 1) / lines; });
  EXPECT_TRUE(predict(fullest).feasible);
  EXPECT_FALSE(predict(test::input_of(two_groups(), kFakeProtocol)).remedies.buses);
}

TEST(Prediction, ImpossiblePlanIsToldInBoundedTime) {
  ScheduleInput input = test::input_of(two_groups(), kFakeProtocol);
  for (Point& point : input.points) point.refresh = 1ns;
  const Prediction prediction = predict(input, {.max_reads = 2000});
  EXPECT_FALSE(prediction.feasible);
  EXPECT_LE(prediction.reads, 2000u);
}

TEST(Prediction, NothingToReadIsFeasible) {
  const Prediction prediction = predict(ScheduleInput{});
  EXPECT_TRUE(prediction.feasible);
  EXPECT_EQ(prediction.load, 0.0);
}

}  // namespace
}  // namespace fieldcast
