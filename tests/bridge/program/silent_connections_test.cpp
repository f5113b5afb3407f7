#include <gmock/gmock.h>

#include <vector>

#include "bridge/program/module/relay_end.hpp"

namespace fieldcast {
namespace {

using program::SilentConnections;

TEST(SilentConnections, OneMoreFromAFullAddressDisplacesItsOldest) {
  std::vector<int> cut;
  const auto cuts = [&](int number) { return [&cut, number] { cut.push_back(number); }; };
  SilentConnections silent(10, 2);
  const auto first = silent.add("a", cuts(1));
  const auto second = silent.add("a", cuts(2));
  (void)silent.add("b", cuts(3));
  (void)silent.add("a", cuts(4));
  EXPECT_THAT(cut, testing::ElementsAre(1));
  EXPECT_FALSE(silent.remove(first));
  EXPECT_TRUE(silent.remove(second));  // it sent data
  (void)silent.add("a", cuts(5));
  EXPECT_THAT(cut, testing::ElementsAre(1));
}

TEST(SilentConnections, WhenAllIsFullTheAddressWithTheMostLosesItsOldest) {
  std::vector<int> cut;
  const auto cuts = [&](int number) { return [&cut, number] { cut.push_back(number); }; };
  SilentConnections silent(4, 3);
  (void)silent.add("engineer", cuts(1));
  for (int i = 2; i <= 4; ++i) (void)silent.add("flood", cuts(i));
  (void)silent.add("other", cuts(5));
  EXPECT_THAT(cut, testing::ElementsAre(2));
  EXPECT_TRUE(silent.cut_one());
  EXPECT_THAT(cut, testing::ElementsAre(2, 3));
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(silent.cut_one());
  EXPECT_FALSE(silent.cut_one());
  EXPECT_THAT(cut, testing::ElementsAre(2, 3, 1, 4, 5));  // the oldest among equals
  EXPECT_EQ(silent.size(), 0u);
}

}  // namespace
}  // namespace fieldcast
