#include "tools/cli/model/command_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/tools/cli/parsed_json.hpp"

namespace fieldcast::cli {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

Value value(std::string_view type, std::string_view text) {
  return value_from_text(parse_type(type).value(), text).value();
}

TEST(Assignment, SplitsAtTheFirstEqualsSign) {
  const auto assignment = Assignment::parse("bus/device/name=a=b").value();
  EXPECT_EQ(assignment.path, (ChannelPath{"bus", "device", "name"}));
  EXPECT_EQ(assignment.value, "a=b");
  EXPECT_EQ(Assignment::parse("bus/device/name=")->value, "");
  EXPECT_EQ(Assignment::parse("bus/device/name=a/b")->value, "a/b");
}

TEST(Assignment, RefusesWhatIsNotAChannelOrSetsNothing) {
  for (const auto* text :
       {"bus/device/name", "bus/device=1", "device=1", "a/b/c/d=1", "//=1", "=1", ""}) {
    EXPECT_FALSE(Assignment::parse(text)) << text;
  }
}

TEST(Target, IsADeviceOrAChannel) {
  EXPECT_EQ(parse_device_or_channel("bus/device").value(), (ChannelPath{"bus", "device", ""}));
  EXPECT_EQ(parse_device_or_channel("bus/device/c").value(), (ChannelPath{"bus", "device", "c"}));
  for (const auto* text : {"bus", "bus/", "/device", "a/b/c/d", ""})
    EXPECT_FALSE(parse_device_or_channel(text)) << text;
}

TEST(TypeText, UnderstandsEveryTypeAndStringsWithTheirLength) {
  for (const auto* text : {"bool", "int16", "uint16", "int32", "uint32", "int64", "uint64",
                           "float32", "float64", "bcd8", "bcd16", "bcd32", "int8", "uint8"}) {
    EXPECT_TRUE(parse_type(text)) << text;
  }
  EXPECT_EQ(parse_type("string(16)")->string_bytes, 16);
  for (const auto* text : {"string", "string()", "string(0)", "string(251)", "string(3",
                           "string(3)x", "int16(2)", "real", ""}) {
    EXPECT_FALSE(parse_type(text)) << text;
  }
}

TEST(ValueText, BecomesWhatTheChannelWants) {
  EXPECT_EQ(value("bool", "on"), Value{true});
  EXPECT_EQ(value("int16", "-12"), Value{std::int64_t{-12}});
  EXPECT_EQ(value("uint64", "18446744073709551615"),
            Value{std::numeric_limits<std::uint64_t>::max()});
  EXPECT_EQ(value("float32", "2.5"), Value{2.5});
  EXPECT_EQ(value("string(4)", "12"), Value{std::string("12")});
}

TEST(ValueText, FractionForAnIntegerIsTheBridgesToJudge) {  // the channel may be scaled
  EXPECT_EQ(value("int16", "21.5"), Value{21.5});
  EXPECT_EQ(value("int16", "70000"), Value{std::int64_t{70000}});
}

TEST(ValueText, RefusesWhatIsNotAValueOfTheKind) {
  EXPECT_THAT(value_from_text(parse_type("int16").value(), "warm").error().text,
              HasSubstr("'warm' is no number"));
  EXPECT_THAT(value_from_text(parse_type("bool").value(), "maybe").error().text,
              HasSubstr("is no bool"));
  EXPECT_EQ(value_from_text(parse_type("float32").value(), "").error().cause, Cause::kWrongType);
}

TEST(ValueText, ANumberBeyondEveryTypeIsOutOfRange) {
  for (const auto* type : {"int16", "uint64", "float32", "float64"}) {
    for (const auto* text : {"18446744073709551616", "1e309", "-1e309"}) {
      const auto refused = value_from_text(parse_type(type).value(), text);
      ASSERT_FALSE(refused) << type << ' ' << text;
      EXPECT_EQ(refused.error().cause, Cause::kRange) << type << ' ' << text;
      EXPECT_EQ(refused.error().text, std::string("'") + text + "' does not fit " + type);
    }
  }
}

Outcome outcome(CommandState state) {
  Outcome done;
  done.bus = "bus";
  done.device = "device";
  done.target = "speed";
  done.write = true;
  done.wanted = {std::int64_t{5}};
  done.result.request_id = 9;
  done.result.state = state;
  done.result.cause = "NONE";
  return done;
}

TEST(Outcomes, EachHasItsExitCode) {
  EXPECT_EQ(exit_code_of(outcome(CommandState::kDone)), ExitCode::kOk);
  EXPECT_EQ(exit_code_of(outcome(CommandState::kVerified)), ExitCode::kOk);
  EXPECT_EQ(exit_code_of(outcome(CommandState::kRejected)), ExitCode::kRejected);
  EXPECT_EQ(exit_code_of(outcome(CommandState::kFailed)), ExitCode::kFailed);
  EXPECT_EQ(exit_code_of(outcome(CommandState::kExpired)), ExitCode::kExpired);
  auto silent = outcome(CommandState::kDone);
  silent.state = Outcome::State::kNoResult;
  EXPECT_EQ(exit_code_of(silent), ExitCode::kNoResponse);
  EXPECT_EQ(exit_code_of(refused_here({"a", "b", "c"}, true, Cause::kUnknownChannel, "?")),
            ExitCode::kRejected);
}

TEST(Outcomes, LineSaysWhatCameOfIt) {
  auto verified = outcome(CommandState::kVerified);
  verified.result.values = {std::int64_t{5}};
  EXPECT_THAT(outcome_line(verified), HasSubstr("bus/device/speed = 5: verified (read back 5)"));
  auto rejected = outcome(CommandState::kRejected);
  rejected.result.cause = "READ_ONLY";
  rejected.result.reason = "the channel is read-only";
  EXPECT_EQ(outcome_line(rejected),
            "bus/device/speed = 5: rejected: the channel is read-only (READ_ONLY)");
  auto read = outcome(CommandState::kDone);
  read.write = false;
  read.wanted.clear();
  read.unit = "rpm";
  read.result.values = {std::int64_t{5}};
  EXPECT_THAT(outcome_line(read), HasSubstr("bus/device/speed = 5 rpm in"));
}

TEST(Outcomes, JsonHasTheFieldsOfTheResult) {
  auto verified = outcome(CommandState::kVerified);
  verified.result.values = {std::int64_t{5}, true};
  const auto json = parsed(outcome_json(verified));
  EXPECT_EQ(json["request_id"], 9);
  EXPECT_EQ(json["state"], "verified");
  EXPECT_EQ(json["values"].dump(), "[5,true]");
  auto silent = verified;
  silent.state = Outcome::State::kNoResult;
  EXPECT_EQ(parsed(outcome_json(silent))["state"], "no-answer");
}

}  // namespace
}  // namespace fieldcast::cli
