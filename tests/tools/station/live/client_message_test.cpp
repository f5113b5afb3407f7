#include "tools/station/live/client_message.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tools/station/live/pending_commands.hpp"

namespace fieldcast::web {
namespace {

using std::chrono::seconds;
using ::testing::HasSubstr;

std::string error_of(std::string_view text) {
  const auto parsed = parse_client_message(text);
  return parsed ? "" : parsed.error().refusal.error;
}

template <class Kind>
Kind parsed(std::string_view text) {
  const auto message = parse_client_message(text);
  EXPECT_TRUE(message.has_value()) << error_of(text);
  return std::get<Kind>(message->what);
}

Value written(const std::string& json) {
  return parsed<WriteChannel>(R"({"write": {"channel": "a/b/c", "value": )" + json + "}}").value;
}

TEST(ClientMessage, SubscriptionsHaveAPatternAndPerhapsARefresh) {
  EXPECT_EQ(parsed<Subscribe>(R"({"subscribe": "press-shop"})").pattern.text(), "press-shop/*/*");
  EXPECT_EQ(parsed<Subscribe>(R"({"subscribe": ""})").pattern.text(), "*/*/*");
  EXPECT_FALSE(parsed<Subscribe>(R"({"subscribe": "*"})").refresh);
  EXPECT_EQ(parsed<Subscribe>(R"({"subscribe": "a/b", "refresh_ms": 62.5})").refresh,
            std::chrono::microseconds{62'500});
  EXPECT_EQ(parsed<Unsubscribe>(R"({"unsubscribe": "a/b/c"})").pattern.text(), "a/b/c");
}

TEST(ClientMessage, ValuesKeepTheirKind) {
  EXPECT_EQ(written("true"), Value(true));
  EXPECT_EQ(written("5"), Value(std::int64_t{5}));
  EXPECT_EQ(written("-5"), Value(std::int64_t{-5}));
  EXPECT_EQ(written("18446744073709551615"), Value(std::uint64_t{18446744073709551615u}));
  EXPECT_EQ(written("5.0"), Value(5.0));
  EXPECT_EQ(written(R"("M7")"), Value(std::string("M7")));
}

TEST(ClientMessage, TheIdIsTheClientsNumber) {
  EXPECT_EQ(parse_client_message(R"({"ping": 5})")->id, 5u);
  EXPECT_EQ(parse_client_message(R"({"acquire": {"channel": "a/b/c"}, "id": 7})")->id, 7u);
  EXPECT_FALSE(parse_client_message(R"({"acquire": {"channel": "a/b/c"}, "id": -7})")->id);
  EXPECT_EQ(parse_client_message(R"({"write": 1, "id": 8})").error().id, 8u);
}

TEST(ClientMessage, EveryFaultSaysWhatItIs) {
  for (const char* text :
       {"", "x", "[]", "7", R"({"subscribe": "*"} x)", "{\"subscribe\": \"\xE4\"}"})
    EXPECT_THAT(error_of(text), HasSubstr("no JSON object")) << text;
  EXPECT_THAT(error_of("{}"), HasSubstr("says nothing that is known"));
  EXPECT_THAT(error_of(R"({"subscribe": 5})"), HasSubstr("a pattern is a text"));
  EXPECT_THAT(error_of(R"({"subscribe": "a//b"})"), HasSubstr("'a//b' is no pattern"));
  EXPECT_THAT(error_of(R"({"subscribe": "a/b/c/d"})"), HasSubstr("is no pattern"));
  EXPECT_THAT(error_of(R"({"subscribe": "*", "rate": 5})"), HasSubstr("no such member"));
  for (const char* ms : {"49", "3600001", "\"5\"", "-1", "1e400"})
    EXPECT_NE(error_of(std::string(R"({"subscribe": "a/b", "refresh_ms": )") + ms + "}"), "");
  EXPECT_THAT(error_of(R"({"subscribe": "a/*/c", "refresh_ms": 500})"), HasSubstr("one device"));
  EXPECT_THAT(error_of(R"({"write": {"value": 5}})"), HasSubstr("the channel is missing"));
  EXPECT_THAT(error_of(R"({"write": {"channel": "a/b", "value": 5}})"), HasSubstr("is no channel"));
  EXPECT_THAT(error_of(R"({"write": {"channel": "a/b/c"}})"), HasSubstr("the value is missing"));
  for (const char* value : {"null", "[1]", "{}"})
    EXPECT_THAT(error_of(R"({"write": {"channel": "a/b/c", "value": )" + std::string(value) + "}}"),
                HasSubstr("no value of a channel"));
  EXPECT_THAT(error_of(R"({"write": {"channel": "a/b/c", "value": 1, "verify": 1}})"),
              HasSubstr("true or false"));
}

TEST(ClientMessage, LengthAndDepthAreBounded) {
  EXPECT_THAT(error_of(R"({"ping": 1, "x": ")" + std::string(kMaxMessage, 'x') + "\"}"),
              HasSubstr("too long or too deep"));
  EXPECT_THAT(error_of(R"({"write": [[[[1]]]]})"), HasSubstr("too long or too deep"));
  EXPECT_THAT(error_of(std::string(4000, '[')), HasSubstr("too long or too deep"));
  EXPECT_EQ(error_of(R"({"ping": 1, "x": "[[[[[[[[\"[["})"), "") << "brackets in a text";
}

TEST(ClientMessage, AValueBecomesWhatTheChannelHas) {
  EXPECT_EQ(value_for("uint64", std::string("18446744073709551615")),
            Value(std::uint64_t{18446744073709551615u}));
  EXPECT_EQ(value_for("int64", std::string("-9007199254740993")),
            Value(std::int64_t{-9007199254740993}));
  EXPECT_EQ(value_for("float32", std::string("2.5")), Value(2.5));
  EXPECT_EQ(value_for("bool", std::int64_t{1}), Value(true));
  EXPECT_EQ(value_for("bool", std::string("on")), Value(true));
  EXPECT_EQ(value_for("string(16)", std::string("5")), Value(std::string("5")));
  EXPECT_FALSE(value_for("string(16)", 5.0));
  EXPECT_FALSE(value_for("int16", std::string("five")));
  EXPECT_EQ(value_for("uint16", std::int64_t{70'000}), Value(std::int64_t{70'000}))
      << "the bridge says that it does not fit";
}

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
