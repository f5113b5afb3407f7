#include "tests/tools/station/api/api_support.hpp"
#include "tools/station/api/base/exchange.hpp"

namespace fieldcast::web {
namespace {

using test::request_of;
using test::utc;

std::string text_of(const HttpResponse& response) {
  const auto json = test::Json::parse(response.body);
  return json.at("error").get<std::string>() + "; " + json.at("hint").get<std::string>();
}

std::string span_fault(const std::string& query) {
  const HttpRequest request = request_of("/x?" + query);
  const auto span = Parameters(request, {"from", "to"}).span(utc(1000), std::chrono::seconds{60});
  return span ? "none" : text_of(span.error());
}

TEST(Parameters, ASpanThatIsMissingIsThePast) {
  const HttpRequest request = request_of("/x");
  const auto span = Parameters(request, {"from", "to"}).span(utc(1000), std::chrono::seconds{60});
  ASSERT_TRUE(span);
  EXPECT_EQ(span->from, utc(940));
  EXPECT_EQ(span->to, utc(1000));
}

TEST(Parameters, ATimeIsMillisecondsOrAText) {
  const auto from = [](const std::string& text) {
    const HttpRequest request = request_of("/x?to=now&from=" + text);
    const auto span = Parameters(request, {"from", "to"}).span(utc(1000), std::chrono::seconds{1});
    return span ? span->from : UtcTime{-1};
  };
  EXPECT_EQ(from("1700000000000"), utc(0));
  EXPECT_EQ(from("1700000000000.5"), (UtcTime{utc(0).nanoseconds + 500'000}));
  EXPECT_EQ(from("0"), (UtcTime{0}));
  EXPECT_EQ(from("2h"), utc(1000 - 7200));
  EXPECT_EQ(from("2023-11-14T22:13:20Z"), utc(0));
}

TEST(Parameters, ASpanThatIsNoneSaysWhereAndWhatAndHow) {
  EXPECT_EQ(span_fault("from=yesterday"),
            "from: 'yesterday' cannot be used; from is Unix milliseconds, or a time such as "
            "2026-11-21T10:30Z, or 2h for two hours ago");
  EXPECT_EQ(span_fault("from=1700000500000&to=1700000400000"),
            "from is not before to; give a from that is earlier; a missing to is now");
  for (const char* const bad : {"1e300", "-1", "nan", "inf", "", "12x", "99999999999999999999"})
    EXPECT_NE(span_fault(std::string("from=") + bad), "none") << bad;
}

TEST(Parameters, NumbersHaveLimits) {
  const auto points = [](const std::string& query) {
    const HttpRequest request = request_of("/x" + query);
    const auto number = Parameters(request, {"points"}).number("points", 2, 100, 10);
    return number ? std::to_string(*number) : text_of(number.error());
  };
  EXPECT_EQ(points(""), "10");
  EXPECT_EQ(points("?points=2"), "2");
  EXPECT_EQ(points("?points=101"),
            "points: '101' cannot be used; points is a whole number from 2 to 100");
  for (const char* const bad : {"1", "-2", "2.5", "", "0x10", "4294967298"})
    EXPECT_NE(points(std::string("?points=") + bad).find("cannot be used"), std::string::npos)
        << bad;
}

TEST(Parameters, ANameThatIsUnknownIsRefused) {
  const auto fault = [](const std::string& query) {
    const HttpRequest request = request_of("/x?" + query);
    const auto refused = Parameters(request, {"channel", "points"}).fault("channel");
    return refused ? text_of(*refused) : "none";
  };
  EXPECT_EQ(fault("point=3"), "the parameter 'point' is unknown; did you mean points?");
  EXPECT_EQ(fault("zzz=3"), "the parameter 'zzz' is unknown; known here: channel, points");
  EXPECT_EQ(fault("points=3&points=4"), "the parameter 'points' came twice; give it once");
  EXPECT_EQ(fault("channel=a/b/c&channel=a/b/d"), "none");
}

TEST(Parameters, WhatCameIsShownWithoutItsControlCharacters) {
  const HttpRequest request = request_of("/x?pattern=a/b/c/d%1B%5B31m");
  const auto pattern = Parameters(request, {"pattern"}).pattern("pattern");
  ASSERT_FALSE(pattern);
  EXPECT_EQ(pattern.error().body.find('\x1B'), std::string::npos);
  EXPECT_EQ(pattern.error().status, 400u);
}

TEST(Parameters, ChannelsAreOneToAFewAndEachOnce) {
  const auto channels = [](const std::string& query) {
    const HttpRequest request = request_of("/x?" + query);
    const auto paths = Parameters(request, {"c"}).channels("c", 2);
    return paths ? std::to_string(paths->size()) : text_of(paths.error());
  };
  EXPECT_EQ(channels("c=a/b/c&c=a/b/d"), "2");
  EXPECT_EQ(channels(""), "c came 0 times; give c=BUS/DEVICE/CHANNEL once to 2 times");
  EXPECT_EQ(channels("c=a/b"), "c: 'a/b' cannot be used; c is BUS/DEVICE/CHANNEL");
  EXPECT_EQ(channels("c=a/b/c&c=a/b/c"),
            "c: 'a/b/c' cannot be used; c is a channel that came only once");
}

}  // namespace
}  // namespace fieldcast::web
