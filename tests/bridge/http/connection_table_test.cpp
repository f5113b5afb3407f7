#include <gmock/gmock.h>

#include "bridge/http/http_guard.hpp"

namespace fieldcast::web {
namespace {

using Phase = ConnectionTable::Phase;
using testing::Optional;

constexpr ConnectionLimits kSmall{.total = 8, .of_one = 4, .working_of_one = 3, .reserved = 2};

class ConnectionTableTest : public testing::Test {
 protected:
  ConnectionTable::Admission open(const std::string& group, bool logged_in = false,
                                  Phase phase = Phase::kWaiting) {
    return table_.open(++last_, {group, logged_in}, phase, now());
  }
  ConnectionTable::Id working(const std::string& group, bool logged_in = false) {
    EXPECT_TRUE(open(group).admitted);
    const ConnectionTable::Id id = last_;
    EXPECT_TRUE(table_.work(id, logged_in).admitted) << id;
    return id;
  }
  Instant now() { return Instant{std::chrono::seconds{++seconds_}}; }

  ConnectionTable table_{kSmall};
  ConnectionTable::Id last_ = 0;
  int seconds_ = 0;
};

TEST_F(ConnectionTableTest, OneAddressHasItsShareAndItsOldestWaitingOneLeaves) {
  EXPECT_FALSE(open("b").evicted);
  for (int i = 0; i < 4; ++i) EXPECT_FALSE(open("a").evicted);
  const auto fifth = open("a");
  EXPECT_TRUE(fifth.admitted);
  EXPECT_THAT(fifth.evicted, Optional(2u));  // the first of "a", not that of "b"
  EXPECT_EQ(table_.size(), 5u);
}

TEST_F(ConnectionTableTest, BeyondTheTotalTheOldestWaitingOneLeaves) {
  for (const char* group : {"a", "b", "c", "d", "e", "f", "g", "h"})
    EXPECT_FALSE(open(group).evicted);
  table_.wait(1, now());  // "a" has received a response
  EXPECT_THAT(open("i").evicted, Optional(2u));
  EXPECT_EQ(table_.size(), 8u);
}

TEST_F(ConnectionTableTest, AConnectionThatWorksIsNeverEvicted) {
  for (const char* group : {"a", "b", "c", "d", "e", "f"}) working(group);
  for (int i = 0; i < 2; ++i) working("g", true);
  const auto refused = open("h");
  EXPECT_FALSE(refused.admitted);
  EXPECT_FALSE(refused.evicted);
  EXPECT_EQ(table_.size(), 8u);
  table_.wait(3, now());
  EXPECT_THAT(open("h").evicted, Optional(3u));
}

TEST_F(ConnectionTableTest, OnlyLoginsWorkInTheReserve) {
  for (const char* group : {"a", "b", "c", "d", "e", "f"}) working(group);
  ASSERT_TRUE(open("g").admitted);
  EXPECT_FALSE(table_.work(last_, false).admitted);
  EXPECT_TRUE(table_.work(last_, true).admitted);
  ASSERT_TRUE(open("g").admitted);
  EXPECT_FALSE(table_.work(last_, false).admitted);
  EXPECT_THAT(open("h").evicted, Optional(8u));  // the refused one waits
  EXPECT_TRUE(table_.work(last_, true).admitted);
}

TEST_F(ConnectionTableTest, AConnectionWithoutALoginLeavesBeforeOneWithALogin) {
  const auto user = working("user", true);
  table_.wait(user, now());  // the oldest of all
  for (int i = 0; i < 7; ++i) EXPECT_FALSE(open("old" + std::to_string(i)).evicted);
  for (int i = 0; i < 7; ++i) {
    EXPECT_THAT(open("new" + std::to_string(i)).evicted, Optional(user + 1 + i));
    EXPECT_TRUE(table_.work(last_, true).admitted);
  }
  EXPECT_THAT(open("last").evicted, Optional(user));  // no other one waits
}

TEST_F(ConnectionTableTest, AnAddressAlwaysHasRoomForALogin) {
  for (int i = 0; i < 3; ++i) working("a");
  ASSERT_TRUE(open("a").admitted);
  EXPECT_FALSE(table_.work(last_, false).admitted);
  const auto next = open("a");
  EXPECT_THAT(next.evicted, Optional(4u));
  EXPECT_TRUE(table_.work(last_, true).admitted);
  EXPECT_FALSE(open("a").evicted);
}

TEST_F(ConnectionTableTest, LoginsOfOneAddressHaveALimitToo) {
  for (int i = 0; i < 4; ++i) working("a", true);
  ASSERT_TRUE(open("a").admitted);
  EXPECT_FALSE(table_.work(last_, true).admitted);
  table_.wait(2, now());
  const auto room = table_.work(last_, true);
  EXPECT_TRUE(room.admitted);
  EXPECT_THAT(room.evicted, Optional(2u));
}

TEST_F(ConnectionTableTest, ALoginThatEndedCountsNoLonger) {
  const auto id = working("a", true);
  table_.wait(id, now());
  for (int i = 0; i < 3; ++i) working("a");
  EXPECT_FALSE(table_.work(id, false).admitted);
  EXPECT_TRUE(table_.work(id, true).admitted);
}

TEST_F(ConnectionTableTest, WhatLeftTheTableHasNoEffect) {
  ASSERT_TRUE(open("a").admitted);
  table_.close(last_);
  table_.close(last_);
  table_.wait(last_, now());
  EXPECT_EQ(table_.size(), 0u);
}

// WebSockets are active from the start and are never evicted.
TEST_F(ConnectionTableTest, ConnectionsThatWorkFromTheStartAreRefusedBeyondTheLimit) {
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(open("a", false, Phase::kWorking).admitted);
  EXPECT_FALSE(open("a", false, Phase::kWorking).admitted);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(open("b", false, Phase::kWorking).admitted);
  EXPECT_FALSE(open("c", false, Phase::kWorking).admitted);
  EXPECT_TRUE(table_.admission({"a", true}, Phase::kWorking).admitted);
  for (int i = 0; i < 2; ++i) EXPECT_TRUE(open("a", true, Phase::kWorking).admitted);
  EXPECT_FALSE(table_.admission({"a", true}, Phase::kWorking).admitted);
  EXPECT_EQ(table_.size(), 8u);
}

TEST_F(ConnectionTableTest, OneHundredAndFiftySlowOnesLeaveTheStationOpen) {
  ConnectionTable table{ConnectionLimits{}};
  for (int i = 0; i < 150; ++i) {
    const auto slow = table.open(++last_, {"a", false}, Phase::kWaiting, now());
    EXPECT_EQ(slow.evicted.has_value(), i >= 128);
  }
  EXPECT_EQ(table.size(), 128u);
  for (int i = 0; i < 128; ++i) {
    EXPECT_FALSE(table.open(++last_, {"b", false}, Phase::kWaiting, now()).evicted);
    EXPECT_TRUE(table.work(last_, i < 64).admitted);
  }
}

TEST(ConnectionTableThatEvictsWork, AWorkingOneLeavesIfNoneWaits) {
  ConnectionTable table(
      {.total = 3, .of_one = 3, .working_of_one = 3, .reserved = 0, .evicts_working = true});
  const auto open = [&](ConnectionTable::Id id) {
    return table.open(id, {"a"}, Phase::kWaiting, Instant{std::chrono::seconds{id}});
  };
  for (const ConnectionTable::Id id : {1u, 2u, 3u}) EXPECT_FALSE(open(id).evicted);
  for (const ConnectionTable::Id id : {1u, 2u}) EXPECT_TRUE(table.work(id, false).admitted);
  EXPECT_THAT(open(4).evicted, Optional(3u));  // it waits
  EXPECT_TRUE(table.work(4, false).admitted);
  EXPECT_THAT(open(5).evicted, Optional(1u));  // all work; this one began to wait first
  EXPECT_EQ(table.size(), 3u);
}

// Regression: two addresses that did not read could keep all others out.
TEST(ConnectionTableThatEvictsWork, AWorkingOneOfAnAddressLeavesForANewAddress) {
  ConnectionTable table(
      {.total = 4, .of_one = 4, .working_of_one = 4, .reserved = 0, .evicts_working = true});
  const auto open = [&](ConnectionTable::Id id, const char* group) {
    return table.open(id, {group}, Phase::kWaiting, Instant{std::chrono::seconds{id}});
  };
  for (const ConnectionTable::Id id : {1u, 2u, 3u, 4u}) {
    EXPECT_FALSE(open(id, id < 3 ? "a" : "b").evicted);
    EXPECT_TRUE(table.work(id, false).admitted);
  }
  const auto scraper = open(5, "c");
  EXPECT_TRUE(scraper.admitted);
  EXPECT_THAT(scraper.evicted, Optional(1u));
  EXPECT_TRUE(table.work(5, false).admitted);
  EXPECT_EQ(table.size(), 4u);
}

}  // namespace
}  // namespace fieldcast::web
