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

}  // namespace
}  // namespace fieldcast::forward
