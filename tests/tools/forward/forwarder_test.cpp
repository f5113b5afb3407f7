#include "tools/forward/forwarder.hpp"

#include <gtest/gtest.h>

namespace fieldcast::forward {
namespace {

TEST(NeededSpace, IsForTheFreePartOfTheQueueAndTheLogOfSqlite) {
  EXPECT_EQ(needed_space(1'000'000'000, 0), 1'100'000'000u);
  EXPECT_EQ(needed_space(1'000'000'000, 400'000'000), 700'000'000u);
}

TEST(NeededSpace, IsForTheLogAloneIfTheQueueIsLargerThanItsLimit) {
  EXPECT_EQ(needed_space(500'000'000, 500'000'000), 100'000'000u);
  EXPECT_EQ(needed_space(500'000'000, 900'000'000), 100'000'000u);
}

}  // namespace
}  // namespace fieldcast::forward
