#include <gtest/gtest.h>

#include <algorithm>

#include "bridge/dds/topics/conversion.hpp"
#include "bridge/station/bus_table.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

PlanReport plan_of(std::size_t groups, std::uint32_t points) {
  PlanReport plan{.load = 0.5, .stretch = 1.25, .slot = 94ms, .hyperperiod = 376ms};
  for (std::size_t g = 0; g < groups; ++g) {
    PlanReport::Group group{.device = "d" + std::to_string(g), .list = g % 3 == 0, .load = 0.01};
    if (g % 2 == 0) {
      group.period = 188ms;
      group.phase = 5ms;
      group.slack = 1ms;
    }
    for (std::uint32_t p = 0; p < points; ++p) {
      PlanReport::Point point{.area = "holding", .first = p, .count = 2, .channels = {"a", "b"}};
      if (g % 2 == 0) {
        point.period = 376ms;
        point.phase = 99ms;
        point.worst_gap = 380ms;
      }
      group.points.push_back(point);
    }
    plan.groups.push_back(group);
  }
  return plan;
}

TEST(PlanConversion, ComesBackAsItWasWhateverItsSize) {
  for (const auto& [groups, points] : {std::pair{0U, 0U},
                                       {1U, 1U},
                                       {3U, 2U},
                                       {64U, 2U},
                                       {65U, 1U},
                                       {2U, 128U},
                                       {3U, 129U},
                                       {1U, 2000U},
                                       {500U, 3U}}) {
    SCOPED_TRACE(std::to_string(groups) + " groups of " + std::to_string(points));
    const PlanReport plan = plan_of(groups, points);
    const auto parts = to_idl("line", plan, 7, {5});
    ASSERT_FALSE(parts.empty());
    PlanReport back;
    std::uint32_t block = 0;
    for (const idl::ReadPlan& part : parts) {
      EXPECT_EQ(part.block(), block++);
      EXPECT_EQ(part.blocks(), parts.size());
      EXPECT_LE(part.groups().size(), kPlanGroupsPerBlock);
      std::size_t carried = 0;
      for (const auto& group : part.groups()) carried += group.points().size();
      EXPECT_LE(carried, kPlanPointsPerBlock);
      append(part, back);
    }
    EXPECT_EQ(back, plan);
  }
}

TEST(PlanParts, APlanIsWholeInAnyOrderOfItsParts) {
  const PlanReport plan = plan_of(3, 129);
  auto parts = to_idl("line", plan, 7, {5});
  ASSERT_GT(parts.size(), 2U);
  std::reverse(parts.begin(), parts.end());
  PlanParts assembly;
  for (std::size_t i = 0; i + 1 < parts.size(); ++i) EXPECT_FALSE(assembly.on_part(parts[i]));
  EXPECT_FALSE(assembly.on_part(parts[0])) << "a part that came twice is no other part";
  const auto whole = assembly.on_part(parts.back());
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->bus, "line");
  EXPECT_EQ(whole->plan, plan);
  EXPECT_EQ(whole->in_force_since, UtcTime{5});
}

TEST(PlanParts, PartsOfTwoPlansAreNeverMixed) {
  const auto old = to_idl("line", plan_of(2, 100), 7, {5});
  const PlanReport plan = plan_of(2, 120);
  const auto now = to_idl("line", plan, 8, {6});
  ASSERT_EQ(old.size(), now.size());
  PlanParts assembly;
  EXPECT_FALSE(assembly.on_part(old[0]));
  EXPECT_FALSE(assembly.on_part(now[1]));
  EXPECT_FALSE(assembly.on_part(old[1])) << "of a plan that is over";
  const auto whole = assembly.on_part(now[0]);
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->plan, plan);
}

TEST(PlanParts, ImpossiblePartsAreLeftOut) {
  auto part = to_idl("line", plan_of(1, 1), 7, {5}).front();
  PlanParts assembly;
  part.block(1);
  EXPECT_FALSE(assembly.on_part(part)) << "part 1 of 1";
  part.block(0);
  part.blocks(0);
  EXPECT_FALSE(assembly.on_part(part));
  part.blocks(kMaxPlanBlocks + 1);
  EXPECT_FALSE(assembly.on_part(part));
}

}  // namespace
}  // namespace fieldcast
