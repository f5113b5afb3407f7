#include <gtest/gtest.h>

#include "bridge/service/process_watch.hpp"

namespace fieldcast {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000, kDay = 86'400 * kSecond;
constexpr UtcTime kToday{1'800'000'000 * kSecond};
UtcTime after(std::int64_t nanoseconds) { return {kToday.nanoseconds + nanoseconds}; }

TEST(IdentityWatch, LooksOnceADay) {
  EXPECT_FALSE(is_look_due(std::nullopt, kToday, kToday));
  EXPECT_FALSE(is_look_due(std::nullopt, kToday, after(kDay - 1)));
  EXPECT_TRUE(is_look_due(std::nullopt, kToday, after(kDay)));
  EXPECT_FALSE(is_look_due(after(400 * kDay), after(kDay), after(2 * kDay - 1)));
}

TEST(IdentityWatch, LooksWhenTheCertificateEndsAndThenOnceADay) {
  const UtcTime end = after(100);
  EXPECT_FALSE(is_look_due(end, kToday, after(99)));
  EXPECT_TRUE(is_look_due(end, kToday, end)) << "good until then, not at it";
  EXPECT_TRUE(is_look_due(end, kToday, after(kSecond)));
  EXPECT_FALSE(is_look_due(end, end, after(kSecond))) << "it was said";
  EXPECT_TRUE(is_look_due(end, end, after(100 + kDay)));
}

TEST(IdentityWatch, LooksAgainWhenTheClockWasSetBack) {
  EXPECT_TRUE(is_look_due(after(10 * kDay), after(kSecond), kToday));
}

}  // namespace
}  // namespace fieldcast
