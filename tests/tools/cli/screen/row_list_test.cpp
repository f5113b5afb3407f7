#include "tools/cli/screen/row_list.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace fieldcast::cli {
namespace {

ListRows rows_of(std::initializer_list<const char*> channels) {
  ListRows rows;
  for (const char* channel : channels) rows.push_back({.id = {"bus", "device", channel}});
  return rows;
}

TEST(RowList, TheSelectionFollowsItsRowOnceSomebodyMoved) {
  RowList list;
  list.assign(rows_of({"a", "b", "c"}));
  list.assign(rows_of({"x", "a", "b", "c"}));
  EXPECT_EQ(list.selected()->id.channel, "x") << "nobody moved: the first row";
  list.move(2);
  EXPECT_EQ(list.selected()->id.channel, "b");
  list.assign(rows_of({"b", "x", "a", "c"}));
  EXPECT_EQ(list.selected()->id.channel, "b");
  EXPECT_EQ(list.index(), 0u);
}

TEST(RowList, ARowThatIsRemovedGivesItsPlaceToTheNext) {
  RowList list;
  list.assign(rows_of({"a", "b", "c"}));
  list.move(1);
  list.assign(rows_of({"a", "c"}));
  EXPECT_EQ(list.selected()->id.channel, "c");
  list.assign(rows_of({"a"}));
  EXPECT_EQ(list.selected()->id.channel, "a");
  list.assign({});
  EXPECT_EQ(list.selected(), nullptr);
  list.move(5);
  list.select(3);
  EXPECT_EQ(list.top(10), 0u);
}

TEST(RowList, ScrollsSoThatTheSelectionIsInSight) {
  RowList list;
  list.assign(rows_of({"a", "b", "c", "d", "e", "f"}));
  EXPECT_EQ(list.top(3), 0u);
  list.move(4);
  EXPECT_EQ(list.top(3), 2u);
  list.move(-1);
  EXPECT_EQ(list.top(3), 2u);
  list.move(-100);
  EXPECT_EQ(list.top(3), 0u);
  list.select(100);
  EXPECT_EQ(list.top(3), 3u);
  EXPECT_EQ(list.top(10), 0u) << "a taller screen shows all";
}

TEST(RowList, TheWheelMovesTheRowsAndKeepsTheSelectionInSight) {
  RowList list;
  list.assign(rows_of({"a", "b", "c", "d", "e", "f"}));
  list.scroll(2, 3);
  EXPECT_EQ(list.top(3), 2u);
  EXPECT_EQ(list.selected()->id.channel, "c");
  list.scroll(100, 3);
  EXPECT_EQ(list.top(3), 3u);
  list.scroll(-100, 3);
  EXPECT_EQ(list.selected()->id.channel, "c");
}

}  // namespace
}  // namespace fieldcast::cli
