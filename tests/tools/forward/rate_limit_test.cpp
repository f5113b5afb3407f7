#include "tools/forward/send/rate_limit.hpp"

#include <gtest/gtest.h>

namespace fieldcast::forward {
namespace {

constexpr Instant kBeginning{std::chrono::seconds{100}};

std::uint64_t sent_in_ten_seconds(RateLimit limit, std::size_t message) {
  std::uint64_t bytes = 0;
  for (Instant now = kBeginning; now < kBeginning + std::chrono::seconds{10};
       now += std::chrono::milliseconds{1}) {
    while (bytes < 10'000'000 && limit.allows(now)) {
      limit.sent(message, now);
      bytes += message;
    }
  }
  return bytes;
}

TEST(RateLimit, BoundsTheBytesASecond) {
  EXPECT_NEAR(static_cast<double>(sent_in_ten_seconds(RateLimit(10'000), 500)), 100'000, 2'000);
  EXPECT_NEAR(static_cast<double>(sent_in_ten_seconds(RateLimit(10'000), 30'000)), 100'000, 30'000);
}

TEST(RateLimit, WithoutALimitEverythingIsAllowed) {
  EXPECT_EQ(sent_in_ten_seconds(RateLimit(0), 1'000), 10'000'000u);
}

}  // namespace
}  // namespace fieldcast::forward
