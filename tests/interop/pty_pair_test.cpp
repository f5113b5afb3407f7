#include "tests/support/pty_pair.hpp"

#include <gtest/gtest.h>

namespace fieldcast::test {
namespace {

TEST(PtyPair, CarriesEveryByteBothWays) {
  const PtyPair pair;
  const int left = ::open(pair.left().c_str(), O_RDWR | O_NOCTTY),
            right = ::open(pair.right().c_str(), O_RDWR | O_NOCTTY);
  for (const auto& [from, to] : {std::pair{left, right}, std::pair{right, left}}) {
    std::array<std::uint8_t, 256> sent{}, got{};
    for (std::size_t i = 0; i < sent.size(); ++i) sent[i] = static_cast<std::uint8_t>(i);
    ASSERT_EQ(::write(from, sent.data(), sent.size()), 256);
    std::size_t size = 0;
    while (size < got.size()) {
      pollfd ready{to, POLLIN, 0};
      ASSERT_EQ(::poll(&ready, 1, 10'000), 1) << "only " << size << " bytes came";
      const ssize_t count = ::read(to, got.data() + size, got.size() - size);
      ASSERT_GT(count, 0);
      size += static_cast<std::size_t>(count);
    }
    EXPECT_EQ(got, sent);
  }
  ::close(left);
  ::close(right);
}

}  // namespace
}  // namespace fieldcast::test
