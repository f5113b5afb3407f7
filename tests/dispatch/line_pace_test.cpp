#include <gtest/gtest.h>

#include "core/dispatch/policy/dispatch_state.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

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

}  // namespace
}  // namespace fieldcast
