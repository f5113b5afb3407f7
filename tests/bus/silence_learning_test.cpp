#include "core/bus/wire/silence_learning.hpp"

#include <gtest/gtest.h>

#include <tuple>
#include <vector>

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

constexpr Duration kStandardSilence{1750us}, kLeastSilence{300us};

// A busy line: each request follows the last exchange after the learned silence.
struct BusyLine {
  std::vector<Duration> needs;  // silence that each device needs before its requests
  SilenceLearning learning{kStandardSilence, kLeastSilence, needs.size()};
  unsigned failures = 0;

  void run(unsigned rounds) {
    for (unsigned round = 0; round < rounds; ++round) {
      for (DeviceIndex device = 0; device < needs.size(); ++device) ask(device);
    }
  }
  void ask(DeviceIndex device, bool lost = false) {
    const Duration rest = learning.silence();
    const bool responded = !lost && rest >= needs[device];
    if (!responded) ++failures;
    learning.ended(device, rest, responded);
  }
};

TEST(SilenceLearning, BeginsWithTheStandard) {
  EXPECT_EQ(SilenceLearning(kStandardSilence, kLeastSilence, 1).silence(), kStandardSilence);
}

TEST(SilenceLearning, KeepsAMarginAboveTheLeast) {
  BusyLine line{{0us, 0us}};
  line.run(1000);
  EXPECT_EQ(line.failures, 0u);
  EXPECT_GT(line.learning.silence(), kLeastSilence);
  EXPECT_LT(line.learning.silence(), 2 * kLeastSilence);
  for (int i = 0; i < 100; ++i) {
    const Duration learned = line.learning.silence();
    line.run(1);
    EXPECT_EQ(line.learning.silence(), learned) << "the search has ended";
  }
}

TEST(SilenceLearning, IsOneStepLongerThanTheMostDemandingDeviceAccepts) {
  for (const Duration need :
       {Duration{350us}, Duration{700us}, Duration{1000us}, Duration{1700us}}) {
    BusyLine line{{0us, need, 0us}};
    line.run(5000);
    EXPECT_GE(line.learning.silence(), std::min(kStandardSilence, Duration(need * 5 / 4)))
        << need.count();
    EXPECT_LE(line.failures, 2u) << need.count();
  }
}

TEST(SilenceLearning, AStandardBelowTheLeastIsKept) {
  BusyLine line{{0us}, SilenceLearning(100us, kLeastSilence, 1)};
  line.run(1000);
  EXPECT_EQ(line.learning.silence(), 100us);
}

TEST(SilenceLearning, TheFirstFailureRestoresTheStandardForAWhile) {
  BusyLine line{{0us, 0us}};
  line.run(2000);
  const Duration learned = line.learning.silence();
  line.ask(0, true);
  EXPECT_EQ(line.learning.silence(), kStandardSilence);
  line.run(SilenceLearning::kPatience / 2 - 1);
  EXPECT_EQ(line.learning.silence(), kStandardSilence);
  line.run(2);
  EXPECT_EQ(line.learning.silence(), learned) << "a failure after many responses is noise";
}

TEST(SilenceLearning, ASecondFailureSoonAfterTheFirstMakesItLonger) {
  BusyLine line{{0us, 0us}};
  line.run(600);
  const Duration learned = line.learning.silence();
  for (int failure = 0; failure < 2; ++failure) {
    line.ask(0, true);
    line.run(SilenceLearning::kPatience / 2 + 1);
  }
  EXPECT_GT(line.learning.silence(), learned);
  EXPECT_LT(line.learning.silence(), kStandardSilence);
}

TEST(SilenceLearning, WhileADeviceDoesNotRespondTheStandardIsInUse) {
  BusyLine line{{0us, 10s}};  // the second one is off
  line.run(5000);
  EXPECT_EQ(line.learning.silence(), kStandardSilence);
  line.needs[1] = 700us;  // on, and slower than the other
  line.run(5000);
  EXPECT_GE(line.learning.silence(), 700us);
  EXPECT_LT(line.learning.silence(), kStandardSilence);
}

TEST(SilenceLearning, AFailureAfterALongRestSaysNothing) {
  BusyLine line{{0us}};
  line.run(2000);
  const Duration learned = line.learning.silence();
  line.learning.ended(0, 50ms, false);
  EXPECT_EQ(line.learning.silence(), kStandardSilence) << "until it responds";
  line.learning.ended(0, 50ms, true);
  EXPECT_EQ(line.learning.silence(), learned);
}

TEST(SilenceLearning, DevicesThatAreNotConfiguredSayNothing) {
  BusyLine line{{0us}};
  line.run(2000);
  const Duration learned = line.learning.silence();
  line.learning.ended(7, learned, true);
  line.learning.ended(7, learned, false);
  EXPECT_EQ(line.learning.silence(), learned);
}

TEST(SilenceLearning, EachStepNeedsSixteenResponsesOfEachDevice) {
  BusyLine line{{0us, 0us}};
  line.run(15);
  line.ask(0);
  EXPECT_EQ(line.learning.silence(), 1750us);
  line.ask(1);
  EXPECT_EQ(line.learning.silence(), 1225us);
  line.run(15);
  EXPECT_EQ(line.learning.silence(), 1225us);
  line.run(1);
  EXPECT_EQ(line.learning.silence(), 857500ns);
}

// Steps of 1750, 1225, 857.5, 600.25, 420.2 and 300 us.
TEST(SilenceLearning, AStepThatFailsTwiceIsExcluded) {
  for (const auto& [need, learned, failures] : {std::tuple{Duration{0us}, Duration{420175ns}, 0u},
                                                {Duration{500us}, Duration{857500ns}, 2u},
                                                {Duration{900us}, Duration{1750us}, 2u},
                                                {Duration{1300us}, Duration{1750us}, 2u}}) {
    BusyLine line{{0us, need, 0us}};
    for (int round = 0; round < 5000; ++round) {
      line.run(1);
      if (line.failures == 2) { ASSERT_GE(line.learning.silence(), learned) << need.count(); }
    }
    EXPECT_EQ(line.learning.silence(), learned) << need.count();
    EXPECT_EQ(line.failures, failures) << need.count();
  }
}

TEST(SilenceLearning, AResponseAfterALongerRestSaysNothingAboutTheStep) {
  SilenceLearning learning(kStandardSilence, kLeastSilence, 1);
  for (int i = 0; i < 16; ++i) learning.ended(0, 1750us, true);
  ASSERT_EQ(learning.silence(), 1225us);
  for (int i = 0; i < 100; ++i) learning.ended(0, 1488us, true);  // nearer to the longer step
  EXPECT_EQ(learning.silence(), 1225us);
  for (int i = 0; i < 16; ++i) learning.ended(0, 1487us, true);
  EXPECT_EQ(learning.silence(), 857500ns);
}

}  // namespace
}  // namespace fieldcast
