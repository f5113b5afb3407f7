#include "tools/station/live/pending_commands.hpp"

#include <gtest/gtest.h>

namespace fieldcast::web {
namespace {

using std::chrono::seconds;

constexpr Instant kStart{seconds{100}};

struct PendingCommandsTest : ::testing::Test {
  void ask(std::uint64_t id, const std::string& user = "anna") {
    book.add({id, {user, Role::kOperator, "10.0.0.7"}, "write 1", "shop/press/oil"}, {},
             kStart + seconds{8});
  }
  static StationResult result_of(std::uint64_t id) {
    StationResult result;
    result.request_id = id;
    result.state = CommandState::kVerified;
    result.cause = "NONE";
    result.values = {1.0};
    return result;
  }
  PendingCommands book;
};

TEST_F(PendingCommandsTest, AResultEndsACommandOnce) {
  ask(7);
  EXPECT_EQ(book.find("anna", 7)->state, "pending");
  const auto ended = book.on_result(result_of(7));
  ASSERT_TRUE(ended);
  EXPECT_EQ(ended->outcome.state, "verified");
  EXPECT_EQ(ended->outcome.user, "anna");
  EXPECT_EQ(ended->outcome.target, "shop/press/oil");
  EXPECT_FALSE(book.on_result(result_of(7)));
  EXPECT_FALSE(book.on_result(result_of(8)));
  EXPECT_EQ(book.find("anna", 7)->state, "verified");
}

TEST_F(PendingCommandsTest, AnOutcomeIsForItsUserOnly) {
  ask(7);
  EXPECT_FALSE(book.find("ben", 7));
  (void)book.on_result(result_of(7));
  EXPECT_FALSE(book.find("ben", 7));
}

TEST_F(PendingCommandsTest, WhatWasNotSentInTimeSaysSo) {
  ask(7);
  EXPECT_FALSE(book.take_expired(kStart + seconds{7}));
  const auto expired = book.take_expired(kStart + seconds{8});
  ASSERT_TRUE(expired);
  EXPECT_EQ(expired->outcome.state, "not-sent");
  EXPECT_FALSE(book.take_expired(kStart + seconds{8}));
}

TEST_F(PendingCommandsTest, WhatWasSentAndHasNoResultSaysSo) {
  ask(7);
  book.on_sent(7, kStart + seconds{20});
  EXPECT_FALSE(book.take_expired(kStart + seconds{19}));
  EXPECT_EQ(book.take_expired(kStart + seconds{20})->outcome.state, "no-answer");
  EXPECT_EQ(book.find("anna", 7)->state, "no-answer");
  book.on_sent(7, kStart);
}

TEST_F(PendingCommandsTest, AFaultEndsIt) {
  ask(7);
  const auto ended = book.on_fault(7, StationFault::kNoBridge);
  ASSERT_TRUE(ended);
  EXPECT_EQ(ended->outcome.state, "not-sent");
  EXPECT_EQ(ended->outcome.reason, "no bridge serves the bus; it was not sent");
}

TEST_F(PendingCommandsTest, OneUserCannotTakeAllPlaces) {
  for (std::size_t i = 0; i < PendingCommands::kMaxOfUser; ++i) {
    EXPECT_FALSE(book.why_not("anna"));
    ask(i);
  }
  EXPECT_TRUE(book.why_not("anna"));
  EXPECT_FALSE(book.why_not("ben"));
  (void)book.on_result(result_of(0));
  EXPECT_FALSE(book.why_not("anna"));
}

TEST_F(PendingCommandsTest, OnlyTheLatestOutcomesAreKept) {
  for (std::uint64_t id = 1; id <= PendingCommands::kMaxKept + 1; ++id) {
    ask(id);
    (void)book.on_result(result_of(id));
  }
  EXPECT_FALSE(book.find("anna", 1));
  EXPECT_TRUE(book.find("anna", 2));
  EXPECT_EQ(book.under_way(), 0u);
}

}  // namespace
}  // namespace fieldcast::web
