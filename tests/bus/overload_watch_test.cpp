#include "core/bus/health/overload_watch.hpp"

#include <gtest/gtest.h>

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

TEST(OverloadWatch, IsToldOnceItHasLastedAndOnce) {
  OverloadWatch watch(1);
  EXPECT_FALSE(watch.update(1.5, Instant{1s}));
  EXPECT_FALSE(watch.update(1.5, Instant{5999ms}));
  const auto told = watch.update(1.5, Instant{6s});
  ASSERT_TRUE(told);
  EXPECT_EQ(told->kind, Notice::Kind::kOverload);
  EXPECT_NE(told->text.find("up to 1.50 times"), std::string::npos) << told->text;
  EXPECT_FALSE(watch.update(1.8, Instant{60s}));
}

TEST(OverloadWatch, AnInterruptionBeginsTheTimeAnew) {
  OverloadWatch watch(1);
  EXPECT_FALSE(watch.update(1.5, Instant{1s}));
  EXPECT_FALSE(watch.update(1.0, Instant{3s}));
  EXPECT_FALSE(watch.update(1.5, Instant{4s}));
  EXPECT_FALSE(watch.update(1.5, Instant{8s}));
  EXPECT_TRUE(watch.update(1.5, Instant{9s}));
}

TEST(OverloadWatch, OfTheConfigurationOnlyTheEndIsNews) {
  OverloadWatch watch(2);
  EXPECT_FALSE(watch.update(2, Instant{1s}));
  EXPECT_FALSE(watch.update(2, Instant{100s}));
  EXPECT_FALSE(watch.update(1, Instant{101s}));
  const auto told = watch.update(1, Instant{106s});
  ASSERT_TRUE(told);
  EXPECT_EQ(told->kind, Notice::Kind::kOverloadEnded);
}

}  // namespace
}  // namespace fieldcast
