#include "bridge/store/tiers/late_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/bridge/store/scratch.hpp"
#include "tests/bridge/store/store_support.hpp"

namespace fieldcast {
namespace {

using test::Scratch;
using test::utc;
using testing::ElementsAre;
using testing::SizeIs;

struct LateTableTest : testing::Test {
  Scratch scratch;
  std::unique_ptr<SqlConnection> connection =
      open_store(StoreAddress(scratch.path("late.db")), IfMissing::kCreate);
  LateTable table{*connection};

  std::vector<LateRange> all() { return table.ranges("b", "d", utc(0), utc(10'000'000)); }
};

TEST_F(LateTableTest, NearRangesAreJoined) {
  table.add("b", "d", {utc(100), utc(200), 5, utc(300)});
  table.add("b", "d", {utc(400), utc(500), 7, utc(600)});
  table.add("b", "e", {utc(250), utc(260), 1, utc(300)});
  EXPECT_THAT(all(), SizeIs(2));
  table.add("b", "d", {utc(260), utc(340), 1, utc(601)});
  EXPECT_THAT(all(), ElementsAre(LateRange{utc(100), utc(500), 13, utc(601)}));
}

TEST_F(LateTableTest, RangesOfATimeAreFound) {
  table.add("b", "d", {utc(100), utc(200), 5, utc(300)});
  table.add("b", "d", {utc(400), utc(500), 7, utc(600)});
  EXPECT_THAT(table.ranges("b", "d", utc(200), utc(300)), SizeIs(1));
  EXPECT_THAT(table.ranges("b", "d", utc(201), utc(300)), SizeIs(0));
  EXPECT_THAT(table.ranges("b", "d", utc(150), utc(450)), SizeIs(2));
}

TEST_F(LateTableTest, TheNewestAreKept) {
  for (std::int64_t i = 0; i < LateTable::kMaxKept + 2; ++i)
    table.add("b", "d", {utc(1000 * i), utc(1000 * i + 1), 1, utc(1)});
  const auto kept = all();
  EXPECT_THAT(kept, SizeIs(LateTable::kMaxKept));
  EXPECT_EQ(kept.front().from, utc(2000));
}

}  // namespace
}  // namespace fieldcast
