#include <gtest/gtest.h>

#include "core/plan/refresh.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

TEST(Cycle, APointIsDueAtTheLastInstantWithinItsGap) {
  const Cycle cycle{Instant{100ns}, 90ns};
  EXPECT_EQ(due_after(cycle, Instant{190ns}, 100ns), Instant{280ns});
  EXPECT_EQ(due_after(cycle, Instant{185ns}, 100ns), Instant{280ns});
  EXPECT_EQ(due_after(cycle, Instant{190ns}, 1000ns), Instant{1180ns});
  EXPECT_EQ(due_after(cycle, Instant{130ns}, 100ns), Instant{230ns}) << "190 would be too soon";
  EXPECT_EQ(due_after(Cycle{}, Instant{130ns}, 100ns), Instant{230ns});
}

TEST(Cycle, PeriodsOfSlowerGroupsAreWholeBasePeriods) {
  EXPECT_EQ(cycle_period(1000ns, 1000ns, 0.06), 940ns);
  EXPECT_EQ(cycle_period(2000ns, 1000ns, 0.06), 1880ns);
  EXPECT_EQ(cycle_period(2500ns, 1000ns, 0.06), 1880ns);
  EXPECT_EQ(cycle_period(10'000ns, 1000ns, 0.06), 9400ns);
}

}  // namespace
}  // namespace fieldcast
