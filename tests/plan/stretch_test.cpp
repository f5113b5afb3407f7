#include <gtest/gtest.h>

#include <vector>

#include "core/plan/refresh.hpp"

namespace fieldcast {
namespace {

PlannedPoint point(int priority, float elasticity = 1) {
  PlannedPoint made;
  made.priority = static_cast<std::int8_t>(priority);
  made.elasticity = elasticity;
  return made;
}

TEST(Stretch, OnePriorityIsStretchedAlike) {
  std::vector<PlannedPoint> points{point(0), point(0)};
  const Stretched stretched = stretch_points(points, 1.5);
  EXPECT_EQ(points[0].stretch, 1.5);
  EXPECT_EQ(points[1].stretch, 1.5);
  EXPECT_EQ(stretched.greatest, 1.5);
  EXPECT_EQ(stretched.priorities, 1u);
  EXPECT_FALSE(stretched.uneven);
}

TEST(Stretch, TheLowestPriorityGivesWayFirstAndNeverStarves) {
  std::vector<PlannedPoint> points{point(1), point(0), point(2)};
  stretch_points(points, 3);
  EXPECT_EQ(points[0].stretch, 1);
  EXPECT_EQ(points[1].stretch, 3);
  EXPECT_EQ(points[2].stretch, 1);
  stretch_points(points, 64);
  EXPECT_EQ(points[1].stretch, 64);
  EXPECT_EQ(points[0].stretch, 16);
  EXPECT_EQ(points[2].stretch, 4);
  EXPECT_EQ(points[1].stretch / points[2].stretch, kMostApart);
}

TEST(Stretch, ElasticityIsTheShareOfTheStretch) {
  std::vector<PlannedPoint> points{point(0, 0.5F), point(0, 2)};
  const Stretched stretched = stretch_points(points, 2);
  EXPECT_EQ(points[0].stretch, 1.5);
  EXPECT_EQ(points[1].stretch, 3);
  EXPECT_EQ(stretched.least_elasticity, 0.5);
  EXPECT_TRUE(stretched.uneven);
}

TEST(Stretch, PointsThatAreNotReadDoNotCount) {
  std::vector<PlannedPoint> points{point(0), point(5, 3)};
  points[1].mode = Mode::kOnDemand;
  const Stretched stretched = stretch_points(points, 2);
  EXPECT_EQ(stretched.priorities, 1u);
  EXPECT_EQ(stretched.greatest, 2);
  EXPECT_FALSE(stretched.uneven);
}

}  // namespace
}  // namespace fieldcast
