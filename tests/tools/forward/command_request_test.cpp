#include "tools/forward/command/command_request.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

namespace fieldcast::forward {
namespace {

using testing::HasSubstr;

constexpr UtcTime kMoment{1'764'360'000'000'000'000};

std::vector<CommandRule> rules() {
  return {{"anna", {*Pattern::parse("line/press.*/setpoint")}}, {"*", {*Pattern::parse("lab")}}};
}

nlohmann::json request() {
  return {{"schema", 1},   {"id", "8c1f"},   {"channel", "line/press.1/setpoint"},
          {"value", 21.5}, {"verify", true}, {"expires_at", kMoment.nanoseconds + 5'000'000'000}};
}

std::string fault(const nlohmann::json& json, const std::string& user = "anna") {
  const auto found = command_request_from(json.dump(), user, rules(), kMoment);
  return found ? "" : found.error().reason;
}

TEST(CommandRequest, IsReadWithItsUser) {
  const auto found = command_request_from(request().dump(), "anna", rules(), kMoment);
  ASSERT_TRUE(found) << found.error().reason;
  EXPECT_EQ(found->user, "anna");
  EXPECT_EQ(found->id, "8c1f");
  EXPECT_EQ(found->channel.text(), "line/press.1/setpoint");
  EXPECT_EQ(found->value, Value{21.5});
  EXPECT_TRUE(found->verify);
  EXPECT_EQ(found->expires_at.nanoseconds, kMoment.nanoseconds + 5'000'000'000);
}

TEST(CommandRequest, ARuleDecidesWhoMayWriteWhat) {
  EXPECT_THAT(fault(request(), "ben"), HasSubstr("'ben' has no right"));
  auto other = request();
  other["channel"] = "line/mill/level";
  EXPECT_THAT(fault(other), HasSubstr("no right to write line/mill/level"));
  other["channel"] = "lab/oven/heat";
  EXPECT_EQ(fault(other, "ben"), "");
  EXPECT_THAT(fault(other, ""), HasSubstr("user's name"));
  EXPECT_THAT(fault(other, "a b"), HasSubstr("user's name"));
}

TEST(CommandRequest, ActionsHaveTheirMembers) {
  auto acquire = request();
  acquire["action"] = "acquire";
  EXPECT_THAT(fault(acquire), HasSubstr("member 'value' is unknown"));
  acquire.erase("value");
  acquire.erase("verify");
  EXPECT_EQ(fault(acquire), "");
  EXPECT_THAT(fault(acquire, "ben"), HasSubstr("no right to acquire"));
  auto shelve = acquire;
  shelve["action"] = "shelve";
  EXPECT_THAT(fault(shelve), HasSubstr("\"limit\" is not"));
  shelve["limit"] = "high-high";
  for (const nlohmann::json& minutes :
       {nlohmann::json(0), nlohmann::json(1441), nlohmann::json(-1), nlohmann::json("5")}) {
    shelve["minutes"] = minutes;
    EXPECT_THAT(fault(shelve), HasSubstr("from 1 to 1440")) << minutes;
  }
  shelve["minutes"] = 30;
  EXPECT_EQ(fault(shelve), "");
  auto acknowledge = shelve;
  acknowledge["action"] = "acknowledge";
  acknowledge.erase("minutes");
  acknowledge["raised_at"] = "5";
  EXPECT_THAT(fault(acknowledge), HasSubstr("\"raised_at\" is not Unix time"));
  acknowledge["raised_at"] = 5;
  EXPECT_EQ(fault(acknowledge), "");
  shelve["raised_at"] = 5;
  EXPECT_THAT(fault(shelve), HasSubstr("member 'raised_at' is unknown"));
  shelve.erase("raised_at");
  shelve["note"] = std::string(257, 'x');
  EXPECT_THAT(fault(shelve), HasSubstr("\"note\" is not"));
  shelve["action"] = "maintenance";
  EXPECT_THAT(fault(shelve), HasSubstr("\"action\" is not"));
  shelve["action"] = 7;
  EXPECT_THAT(fault(shelve), HasSubstr("\"action\" is not"));
  auto empty = request();
  empty[""] = 1;
  EXPECT_THAT(fault(empty), HasSubstr("member '' is unknown"));
}

TEST(CommandRequest, WhatTheCentreEncodesIsReadAtTheSite) {
  const ChannelPath path{"line", "press.1", "setpoint"};
  const UtcTime end{kMoment.nanoseconds + 1};
  const Value large{std::uint64_t{1} << 63};
  for (const CommandRequest& sent :
       {CommandRequest{.channel = path, .value = large, .verify = true},
        CommandRequest{.channel = path, .value = Value{"a\"b"}},
        CommandRequest{.action = CentreAction::kAcquire, .channel = path},
        CommandRequest{.action = CentreAction::kAcknowledge, .channel = path, .note = "seen"},
        CommandRequest{.action = CentreAction::kShelve,
        .channel = path,
        .limit = LimitKind::kLowLow,
        .minutes = 5},
        CommandRequest{.action = CentreAction::kUnshelve, .channel = path}}) {
    CommandRequest full = sent;
    full.id = "7-1";
    full.expires_at = end;
    const auto found = command_request_from(to_json(full), "anna", rules(), kMoment);
    ASSERT_TRUE(found) << found.error().reason;
    EXPECT_EQ(found->action, full.action);
    EXPECT_EQ(found->channel.text(), path.text());
    EXPECT_EQ(found->value, full.value);
    EXPECT_EQ(found->verify, full.verify);
    EXPECT_EQ(found->limit, full.limit);
    EXPECT_EQ(found->note, full.note);
    EXPECT_EQ(found->minutes, full.minutes);
    EXPECT_EQ(found->expires_at, end);
  }
}

TEST(CommandRequest, ItsLifeIsBounded) {
  auto old = request();
  old["expires_at"] = kMoment.nanoseconds;
  EXPECT_EQ(fault(old), "expired");
  EXPECT_EQ(refusal("1", fault(old)).state, "expired");
  old["expires_at"] = kMoment.nanoseconds + 61'000'000'000;
  EXPECT_THAT(fault(old), HasSubstr("at most 60 s"));
  old["expires_at"] = std::numeric_limits<std::int64_t>::min();
  EXPECT_EQ(fault(old), "expired");
}

TEST(CommandRequest, FaultsAreNamedAndKeepTheId) {
  for (const auto& [member, reason] :
       {std::pair{"id", "\"id\" is missing"}, std::pair{"channel", "\"channel\" is missing"},
        std::pair{"value", "\"value\" is missing"},
        std::pair{"expires_at", "\"expires_at\" is missing"}}) {
    auto without = request();
    without.erase(member);
    EXPECT_THAT(fault(without), HasSubstr(reason));
  }
  auto more = request();
  more["force"] = true;
  const auto found = command_request_from(more.dump(), "anna", rules(), kMoment);
  EXPECT_THAT(found.error().reason, HasSubstr("member 'force' is unknown"));
  EXPECT_EQ(found.error().id, "8c1f");
  for (const char* id : {"", "a b", "a/b"}) {
    auto bad = request();
    bad["id"] = id;
    EXPECT_THAT(fault(bad), HasSubstr("\"id\" is missing"));
  }
  auto newer = request();
  newer["schema"] = 2;
  EXPECT_THAT(fault(newer), HasSubstr("schema is not 1"));
  auto list = request();
  list["value"] = {1, 2};
  EXPECT_THAT(fault(list), HasSubstr("\"value\" is not"));
  auto path = request();
  path["channel"] = "line/press";
  EXPECT_THAT(fault(path), HasSubstr("\"channel\": "));
}

TEST(CommandRequest, OtherTextIsRefused) {
  for (const std::string& text :
       {std::string(), std::string("["), std::string("7"), std::string(100'000, '['),
        std::string("\xff\xfe"), std::string(kMaxCommandBytes + 1, ' ')})
    EXPECT_FALSE(command_request_from(text, "anna", rules(), kMoment));
}

TEST(CommandTimes, TheWaitForTheBridgeIsAPartOfTheLifeSpan) {
  using std::chrono::milliseconds;
  const auto times = [](int lifespan) {
    const CommandTimes found = times_within(milliseconds{lifespan});
    return std::pair(found.finding / milliseconds{1}, found.lifespan / milliseconds{1});
  };
  EXPECT_EQ(times(5000), std::pair(2000L, 3000L));
  EXPECT_EQ(times(3000), std::pair(1500L, 1000L)) << "in whole seconds";
  EXPECT_EQ(times(2000), std::pair(1000L, 1000L));
  EXPECT_EQ(times(1000), std::pair(500L, 500L));
  EXPECT_EQ(times(400), std::pair(200L, 200L));
}

TEST(CommandResponse, IsJson) {
  const auto json = nlohmann::json::parse(to_json({.id = "8c1f",
                                                   .state = "verified",
                                                   .cause = "NONE",
                                                   .values = {Value{21.5}},
                                                   .completed_at = kMoment}));
  EXPECT_EQ(json.at("id"), "8c1f");
  EXPECT_EQ(json.at("state"), "verified");
  EXPECT_EQ(json.at("values"), nlohmann::json({21.5}));
  EXPECT_EQ(json.at("completed_at"), kMoment.nanoseconds);
}

TEST(CommandResponse, IsReadAtTheCentre) {
  const CommandResponse sent{.id = "8c1f",
                             .state = "rejected",
                             .cause = "OUT_OF_RANGE",
                             .reason = "too\nlarge",
                             .values = {Value{21.5}, Value{"x"}},
                             .completed_at = kMoment};
  const auto found = command_response_from(to_json(sent));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->state, "rejected");
  EXPECT_EQ(found->cause, "OUT_OF_RANGE");
  EXPECT_EQ(found->reason, "too\\nlarge");
  EXPECT_EQ(found->values, sent.values);
  EXPECT_EQ(found->completed_at, kMoment);
  for (const char* bad :
       {"", "[]", "7", R"({"schema":2})", R"({"schema":1,"id":"1"})",
        R"({"schema":1,"id":"1","state":"done","cause":"","reason":"","completed_at":"x"})",
        R"({"schema":1,"id":"1","state":"done","cause":"","reason":"","values":[{}],)"
        R"("completed_at":1})"})
    EXPECT_FALSE(command_response_from(bad)) << bad;
  EXPECT_FALSE(command_response_from(std::string(20'000, ' ')));
}

}  // namespace
}  // namespace fieldcast::forward
