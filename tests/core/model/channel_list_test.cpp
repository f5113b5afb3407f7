#include "core/model/channel_list.hpp"

#include <gtest/gtest.h>

#include <utility>

namespace fieldcast {
namespace {

ChannelSpec named(const std::string& name) {
  ChannelSpec channel;
  channel.name = name;
  return channel;
}

TEST(ChannelList, CopiesShareTheirElementsUntilOneChanges) {
  ChannelList list{named("a"), named("b")};
  ChannelList copy = list;
  EXPECT_EQ(&std::as_const(copy)[0], &std::as_const(list)[0]);
  EXPECT_EQ(copy, list);

  copy[0].name = "c";
  EXPECT_NE(&std::as_const(copy)[0], &std::as_const(list)[0]);
  EXPECT_EQ(std::as_const(copy)[0].name, "c");
  EXPECT_EQ(std::as_const(list)[0].name, "a");
  EXPECT_NE(copy, list);

  const ChannelSpec* const own = &std::as_const(copy)[0];
  copy.front().name = "d";  // not shared any more: no further copy
  EXPECT_EQ(&std::as_const(copy)[0], own);
}

TEST(ChannelList, EveryChangeLeavesOtherCopiesAsTheyWere) {
  const ChannelList before{named("a"), named("b")};
  ChannelList list = before;
  list.push_back(named("c"));
  ChannelList next = list;
  next.resize(1);
  ChannelList last = next;
  last.own().pop_back();
  next.clear();
  EXPECT_EQ(before.size(), 2u);
  EXPECT_EQ(list.size(), 3u);
  EXPECT_TRUE(next.empty());
  EXPECT_TRUE(last.empty());
  EXPECT_EQ(next, ChannelList());
  EXPECT_EQ(last, ChannelList());  // equal by their elements
}

TEST(ChannelList, AnEmptyListCanGrow) {
  ChannelList list;
  EXPECT_TRUE(std::as_const(list).empty());
  EXPECT_EQ(std::as_const(list).begin(), std::as_const(list).end());
  list.emplace_back().name = "a";
  EXPECT_EQ(std::as_const(list).back().name, "a");
}

}  // namespace
}  // namespace fieldcast
