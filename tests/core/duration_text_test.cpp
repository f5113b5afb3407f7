#include "core/base/duration_text.hpp"

#include <gtest/gtest.h>

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

TEST(DurationText, IsANumberDirectlyFollowedByItsUnit) {
  EXPECT_EQ(duration_from("500us"), Duration{500us});
  EXPECT_EQ(duration_from("0.25ms"), Duration{250us});
  EXPECT_EQ(duration_from("20ms"), Duration{20ms});
  EXPECT_EQ(duration_from("1.5s"), Duration{1500ms});
  EXPECT_EQ(duration_from("30m"), Duration{30min});
  EXPECT_EQ(duration_from("30min"), Duration{30min});
  EXPECT_EQ(duration_from("1h"), Duration{1h});
  EXPECT_EQ(duration_from("30d"), Duration{720h});
  EXPECT_EQ(duration_from("0s"), Duration{});
  for (const auto* text : {"", "s", "m", "1", "1 s", "-1s", "+1s", "1.s", ".5s", "1.2.3s", "1e3s",
                           "0x1s", "infs", "nans", "1y", "1sms", "1hh", "1S", "1h30m"})
    EXPECT_EQ(duration_from(text), std::nullopt) << text;
}

TEST(DurationText, TooLargeForItsTypeIsLongerThanEveryLimit) {
  for (const auto* text : {"9999999999999s", "99999999999999999999999999min", "400000d"})
    EXPECT_GT(duration_from(text), Duration{24h * 36'500}) << text;
  EXPECT_GT(duration_from(std::string(400, '9') + "us"), Duration{24h * 36'500});
}

TEST(DurationText, WhatIsPrintedReadsBackAsTheSame) {
  for (const Duration each :
       {Duration{}, Duration{1us}, Duration{1500us}, Duration{999'999us}, Duration{1s},
        Duration{60s}, Duration{90s}, Duration{2min}, Duration{1h}, Duration{90min}, Duration{24h},
        Duration{36h}, Duration{48h}, Duration{25h + 1s}, Duration{720h}, Duration{24h * 36'500}})
    EXPECT_EQ(duration_from(to_text(each)), each) << to_text(each);
}

TEST(DurationText, FaultsSayWhatIsWrongAndWhatWasMeant) {
  const auto fault = [](std::string_view text) {
    const auto read = read_duration(text, {1ms, 24h});
    return read ? "none" : fault_text(text, read.error());
  };
  const std::string form = "; allowed: a number with us, ms, s, min, h or d, 1ms to 24h";
  EXPECT_EQ(fault("1ms"), "none");
  EXPECT_EQ(fault("24h"), "none");
  EXPECT_EQ(fault("0s"), "'0s' is too short; allowed: 1ms to 24h");
  EXPECT_EQ(fault("2d"), "'2d' is too long; allowed: 1ms to 24h");
  EXPECT_EQ(fault("500"), "'500' has no unit" + form + "; did you mean 500ms?");
  EXPECT_EQ(fault("2"), "'2' has no unit" + form + "; did you mean 2s?");
  EXPECT_EQ(fault("-1s"), "'-1s' is negative" + form);
  EXPECT_EQ(fault("1 hour"), "'1 hour' is no duration" + form + "; did you mean 1h?");
  EXPECT_EQ(fault("1,5s"), "'1,5s' is no duration" + form + "; did you mean 1.5s?");
  EXPECT_EQ(fault(".5s"), "'.5s' is no duration" + form + "; did you mean 0.5s?");
  EXPECT_EQ(fault("9days"), "'9days' is no duration" + form) << "9d would be too long";
  EXPECT_EQ(fault("soon"), "'soon' is no duration" + form);
}

TEST(DurationText, ANumberAloneIsSecondsWhereThatIsSaid) {
  EXPECT_EQ(read_duration("20", {0s, 1h, true}), Duration{20s});
  EXPECT_EQ(read_duration("0", {0s, 1h, true}), Duration{});
  EXPECT_EQ(read_duration("0.5", {0s, 1h, true}), Duration{500ms});
  EXPECT_FALSE(read_duration("-1", {0s, 1h, true}));
}

}  // namespace
}  // namespace fieldcast
