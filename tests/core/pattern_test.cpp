#include <gtest/gtest.h>

#include "core/base/message_text.hpp"
#include "core/model/channel_pattern.hpp"

namespace fieldcast {
namespace {

Pattern pattern(std::string_view text) { return Pattern::parse(text).value(); }

TEST(Glob, StarStandsForAnyRun) {
  EXPECT_TRUE(glob_matches("*", ""));
  EXPECT_TRUE(glob_matches("oil-*", "oil-temperature"));
  EXPECT_TRUE(glob_matches("*-temp*", "oil-temperature"));
  EXPECT_TRUE(glob_matches("a*b*c", "a-b-b-c"));
  EXPECT_FALSE(glob_matches("a*b*c", "a-b-b-d"));
  EXPECT_FALSE(glob_matches("", "a"));
  EXPECT_FALSE(glob_matches("oil", "oil-temperature"));
  EXPECT_TRUE(glob_matches(std::string_view("*a*").substr(0, 2), "aba"));
  EXPECT_FALSE(glob_matches(std::string_view("oil").substr(0, 2), "oil"));
  EXPECT_FALSE(glob_matches("oil-*t", "oil-"));
}

TEST(Glob, ManyStarsEndSoon) {  // exponential matchers would not return
  std::string stars;
  for (int i = 0; i < 64; ++i) stars += "*a";
  EXPECT_FALSE(glob_matches(stars + "b", std::string(4096, 'a')));
}

TEST(PatternText, ShorterOneMatchesAllBelow) {
  EXPECT_TRUE(pattern("").matches("bus", "device", "channel"));
  EXPECT_TRUE(pattern("press-shop").matches("press-shop", "press-1", "running"));
  EXPECT_TRUE(pattern("press-shop/press-1").matches("press-shop", "press-1", "running"));
  EXPECT_FALSE(pattern("press-shop/press-1").matches("press-shop", "press-10", "running"));
  EXPECT_FALSE(pattern("press").matches("press-shop", "press-1", "running"));
  EXPECT_EQ(pattern("press-shop").text(), "press-shop/*/*");
}

TEST(PatternText, MatchesBusesAndDevicesByTheirSegments) {
  EXPECT_TRUE(pattern("press-*/*/oil").matches("press-shop"));
  EXPECT_TRUE(pattern("press-*/p*/oil").matches("press-shop", "p1"));
  EXPECT_FALSE(pattern("press-*/p*/oil").matches("press-shop", "q1"));
}

TEST(PatternText, RefusesFourSegmentsAndEmptyOnes) {
  EXPECT_FALSE(Pattern::parse("a/b/c/d"));
  EXPECT_FALSE(Pattern::parse("a//c"));
  EXPECT_FALSE(Pattern::parse("a/b/"));
  EXPECT_FALSE(Pattern::parse("/b"));
}

TEST(NearMiss, OneSlipOfTheFingerIsUnderstood) {
  constexpr std::string_view words[]{"coil", "holding", "input-register"};
  EXPECT_EQ(near_miss("holdin", words), "holding");
  EXPECT_EQ(near_miss("hodling", words), "holding");
  EXPECT_EQ(near_miss("Coil", words), "coil");
  EXPECT_EQ(near_miss("imput-regster", words), "input-register");
  EXPECT_EQ(near_miss("modbus-rut", std::vector<std::string>{"modbus-tcp", "modbus-rtu"}),
            "modbus-rtu");
}

TEST(NearMiss, AnotherWordIsNotANearMiss) {
  constexpr std::string_view words[]{"coil", "holding"};
  EXPECT_EQ(near_miss("banana", words), "");
  EXPECT_EQ(near_miss("", words), "");
  EXPECT_EQ(near_miss(std::string(1000, 'c'), words), "");
}

TEST(ChannelPathText, HasThreeSegments) {
  const auto path = ChannelPath::parse("press-shop/press-1/running");
  ASSERT_TRUE(path);
  EXPECT_EQ(path->bus, "press-shop");
  EXPECT_EQ(path->device, "press-1");
  EXPECT_EQ(path->channel, "running");
  for (const char* text : {"", "a", "a/b", "/b/c", "a//c", "a/b/", "a/b/c/d"})
    EXPECT_FALSE(ChannelPath::parse(text)) << text;
}

}  // namespace
}  // namespace fieldcast
