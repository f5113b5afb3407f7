#include <gtest/gtest.h>

#include "core/bus/health/learning.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

constexpr Instant kNow{1s};
Range items(std::uint32_t first, std::uint32_t end) { return {0, first, end - first}; }

TEST(BlockLearning, ABlockWhoseEveryItemIsReadInPiecesWasTooLong) {
  BlockLearning learning;
  EXPECT_FALSE(learning.read(items(0, 12), kNow));
  learning.refused(items(0, 40), {items(0, 20), items(20, 40)});
  EXPECT_EQ(learning.longest(), 0u) << "perhaps an address is bad";
  EXPECT_FALSE(learning.read(items(0, 20), kNow));
  EXPECT_TRUE(learning.read(items(20, 40), kNow));
  EXPECT_EQ(learning.longest(), 20u);
  EXPECT_EQ(learning.largest_read(), 20u);
  EXPECT_TRUE(learning.gaps().empty());
}

TEST(BlockLearning, ItemsThatThePiecesLeftOutAreARefusedGap) {
  BlockLearning learning;
  learning.refused(items(0, 10), {items(0, 2), items(8, 10)});
  EXPECT_FALSE(learning.read(items(0, 2), kNow));
  EXPECT_FALSE(learning.read(items(8, 10), kNow));
  EXPECT_EQ(learning.longest(), 0u);
  EXPECT_EQ(learning.gaps(), std::vector<Range>{items(2, 8)});
  EXPECT_FALSE(learning.read(items(0, 10), kNow));
  EXPECT_TRUE(learning.gaps().empty()) << "it is bridged again";
}

TEST(BlockLearning, ABadAddressExplainsTheRefusal) {
  BlockLearning learning;
  learning.refused(items(0, 10), {items(0, 5), items(5, 10)});
  learning.refused(items(0, 5), {items(0, 5)});
  learning.bad(items(0, 5));
  EXPECT_FALSE(learning.read(items(5, 10), kNow));
  EXPECT_FALSE(learning.read(items(0, 5), kNow));
  EXPECT_EQ(learning.longest(), 0u);
}

TEST(BlockLearning, WhatWasLearnedIsForgotten) {
  BlockLearning learning;
  learning.refused(items(0, 4), {items(0, 2), items(2, 4)});
  EXPECT_FALSE(learning.read(items(0, 2), kNow));
  EXPECT_TRUE(learning.read(items(2, 4), kNow));
  EXPECT_FALSE(learning.expire(kNow + BlockLearning::kRemember / 2));
  EXPECT_TRUE(learning.expire(kNow + BlockLearning::kRemember));
  EXPECT_EQ(learning.longest(), 0u);
  EXPECT_FALSE(learning.forget()) << "nothing was known any more";
}

TEST(BlockLearning, AfterForgettingALengthIsLearnedAgain) {
  BlockLearning learning;
  const auto halve = [&](Instant now) {
    learning.refused(items(0, 2), {items(0, 1), items(1, 2)});
    EXPECT_FALSE(learning.expire(now));
    EXPECT_FALSE(learning.read(items(0, 1), now));
    EXPECT_FALSE(learning.expire(now));
    return learning.read(items(1, 2), now);
  };
  EXPECT_TRUE(halve(kNow));
  EXPECT_EQ(learning.longest(), 1u);
  EXPECT_TRUE(learning.expire(kNow + BlockLearning::kRemember));
  EXPECT_EQ(learning.longest(), 0u);
  EXPECT_TRUE(halve(kNow + 2 * BlockLearning::kRemember));
  EXPECT_EQ(learning.longest(), 1u);
}

TEST(BlockLearning, ABlockThatIsAcceptedAfterAllTeachesNothing) {
  BlockLearning learning;
  learning.refused(items(0, 10), {items(0, 5), items(5, 10)});
  EXPECT_FALSE(learning.read(items(0, 5), kNow));
  EXPECT_FALSE(learning.read(items(0, 10), kNow));
  EXPECT_FALSE(learning.read(items(5, 10), kNow));
  EXPECT_EQ(learning.longest(), 0u);
}

TEST(BlockLearning, ARefusedPartOfARefusedBlockIsTheSameSearch) {
  BlockLearning learning;
  learning.refused(items(0, 40), {items(0, 10), items(10, 20), items(20, 40)});
  learning.refused(items(0, 20), {items(0, 10), items(10, 20)});
  EXPECT_FALSE(learning.read(items(0, 10), kNow));
  EXPECT_FALSE(learning.read(items(10, 20), kNow)) << "items 20 to 39 are still to be read";
  EXPECT_TRUE(learning.read(items(20, 40), kNow));
}

TEST(BlockLearning, BlocksAcrossTheBordersOfARefusedOneCountForTheirPart) {
  BlockLearning learning;
  learning.refused(items(10, 20), {items(10, 15), items(15, 20)});
  EXPECT_FALSE(learning.read(items(5, 15), kNow));
  EXPECT_TRUE(learning.read(items(15, 25), kNow));
  EXPECT_EQ(learning.longest(), 9u) << "ten items were accepted before and are refused now";
  EXPECT_EQ(learning.largest_read(), 9u);
  EXPECT_TRUE(learning.gaps().empty());
}

TEST(BlockLearning, ABlockBesideARefusedOneSaysNothingAboutIt) {
  BlockLearning learning;
  learning.refused(items(10, 20), {items(10, 12)});
  EXPECT_FALSE(learning.read(items(0, 10), kNow));
  EXPECT_FALSE(learning.read(items(20, 30), kNow));
  EXPECT_FALSE(learning.read(items(10, 12), kNow));
  EXPECT_EQ(learning.gaps(), std::vector<Range>{items(12, 20)});
}

TEST(BlockLearning, OnlyABlockWithinAGapOrAcrossItsBordersClosesIt) {
  for (const auto& [block, closes] : {std::pair{items(0, 2), false},
                                      {items(8, 10), false},
                                      {items(0, 3), true},
                                      {items(7, 10), true},
                                      {items(4, 5), true}}) {
    BlockLearning learning;
    learning.refused(items(0, 10), {items(0, 2), items(8, 10)});
    EXPECT_FALSE(learning.read(items(0, 2), kNow));
    EXPECT_FALSE(learning.read(items(8, 10), kNow));
    EXPECT_FALSE(learning.read(block, kNow));
    EXPECT_EQ(learning.gaps().empty(), closes) << block.first << ".." << block.end();
  }
}

TEST(BlockLearning, EachGapOfABlockIsFoundOnce) {
  BlockLearning learning;
  for (int time = 0; time < 2; ++time) {
    learning.refused(items(0, 10), {items(1, 2), items(4, 6)});
    EXPECT_FALSE(learning.read(items(1, 2), kNow));
    EXPECT_FALSE(learning.read(items(4, 6), kNow));
    EXPECT_EQ(learning.gaps(), (std::vector{items(0, 1), items(2, 4), items(6, 10)}));
  }
}

TEST(BlockLearning, TheOldestOfTooManyGapsIsForgotten) {
  BlockLearning learning;
  for (std::uint32_t i = 0; i <= BlockLearning::kMostGaps; ++i) {
    learning.refused(items(10 * i, 10 * i + 9), {items(10 * i, 10 * i + 1)});
    EXPECT_FALSE(learning.read(items(10 * i, 10 * i + 1), kNow));
  }
  ASSERT_EQ(learning.gaps().size(), BlockLearning::kMostGaps);
  EXPECT_EQ(learning.gaps().front(), items(11, 19));
  EXPECT_EQ(learning.gaps().back(), items(641, 649));
}

TEST(BlockLearning, ALengthThatIsConfirmedIsNoChangeAndIsRememberedLonger) {
  BlockLearning learning;
  const auto halve = [&](Instant now) {
    learning.refused(items(0, 40), {items(0, 20), items(20, 40)});
    EXPECT_FALSE(learning.read(items(0, 20), now));
    return learning.read(items(20, 40), now);
  };
  EXPECT_TRUE(halve(kNow));
  EXPECT_FALSE(halve(kNow + 30min)) << "20 items, as before";
  EXPECT_FALSE(learning.expire(kNow + 89min));
  EXPECT_TRUE(learning.expire(kNow + 90min));
}

TEST(BlockLearning, MemoryIsBounded) {
  BlockLearning learning;
  for (std::uint32_t i = 0; i < 1000; ++i)
    learning.refused(items(10 * i, 10 * i + 9),
                     {items(10 * i, 10 * i + 1), items(10 * i + 8, 10 * i + 9)});
  for (std::uint32_t i = 0; i < 1000; ++i) {
    (void)learning.read(items(10 * i, 10 * i + 1), kNow);
    (void)learning.read(items(10 * i + 8, 10 * i + 9), kNow);
  }
  EXPECT_EQ(learning.gaps().size(), BlockLearning::kMostOpen)
      << "the searches that were not given up";
  EXPECT_EQ(learning.gaps().back(), items(9991, 9998));
}

TEST(PauseLearning, ADeviceThatIsDeafAfterItsResponsesIsGivenARest) {
  PauseLearning learning;
  int asked = 0;
  for (; learning.pause() < 10ms && asked < 400; ++asked) {
    // The device ignores requests for 8 ms.
    learning.tried(learning.pause() + 1ms, learning.pause() + 1ms > 8ms);
    learning.tried(200ms, true);
  }
  EXPECT_EQ(learning.pause(), 10ms);
  for (; asked < 1000; ++asked) {
    learning.tried(11ms, true);
    learning.tried(200ms, true);
  }
  EXPECT_EQ(learning.pause(), 10ms);
  learning.forget();
  EXPECT_EQ(learning.pause(), Duration::zero());
}

struct PauseTries : testing::Test {
  void tried(int times, Duration rest, bool responded) {
    for (int i = 0; i < times; ++i) learning.tried(rest, responded);
  }
  PauseLearning learning;
};

TEST_F(PauseTries, TwelveOfEachKindAreEnough) {
  tried(11, 1ms, false);
  tried(20, 5s, true);
  EXPECT_EQ(learning.pause(), 0ms);
  tried(1, 1ms, false);
  EXPECT_EQ(learning.pause(), 2ms);
}

TEST_F(PauseTries, TheResponsesAfterAllLongerRestsCountTogether) {
  tried(12, 1ms, false);
  tried(5, 200ms, true);
  tried(6, 400ms, true);
  EXPECT_EQ(learning.pause(), 0ms);
  tried(1, 5s, true);
  EXPECT_EQ(learning.pause(), 2ms);
}

TEST_F(PauseTries, LongerRestsMustSucceedNineteenTimesOfTwenty) {
  tried(12, 1ms, false);
  tried(1, 200ms, false);
  tried(3, 200ms, true);
  tried(15, 400ms, true);
  EXPECT_EQ(learning.pause(), 0ms) << "1 failure of 19";
  tried(2, 400ms, true);
  EXPECT_EQ(learning.pause(), 2ms) << "1 failure of 21";
}

TEST_F(PauseTries, HalfOfTheShortRestsMustFail) {
  tried(7, 1ms, true);
  tried(6, 1ms, false);
  tried(12, 5s, true);
  EXPECT_EQ(learning.pause(), 0ms) << "6 failures of 13";
  tried(2, 1ms, false);
  EXPECT_EQ(learning.pause(), 2ms) << "8 failures of 15";
}

TEST_F(PauseTries, FailuresOfLongAgoDoNotCount) {
  tried(12, 1ms, false);
  tried(100, 1ms, true);
  tried(12, 5s, true);
  EXPECT_EQ(learning.pause(), 0ms);
}

TEST(PauseLearning, LongerRestsAreFoundAsWell) {
  for (const Duration deaf : {Duration{30ms}, Duration{65ms}, Duration{180ms}, Duration{800ms}}) {
    PauseLearning learning;
    for (int i = 0; i < 400; ++i) {
      const Duration rest = learning.pause() + 2ms;
      learning.tried(rest, rest >= deaf);
      if (rest < deaf) learning.tried(2 * deaf, true);
    }
    EXPECT_GE(learning.pause(), deaf - 2ms);
    EXPECT_LE(learning.pause(), 2 * deaf);
  }
}

TEST(PauseLearning, ALineThatLosesResponsesAtAnyTimeNeedsNoRest) {
  PauseLearning learning;
  for (int i = 0; i < 1000; ++i) {
    learning.tried(2ms, i % 3 != 0);
    learning.tried(200ms, i % 3 != 0);
  }
  EXPECT_EQ(learning.pause(), Duration::zero());
}

// Receives nothing for `deaf` after each of its responses.
struct DeafDevice {
  Duration deaf;
  PauseLearning& learning;
  int asked = 0, failed = 0;
  void ask(int requests) {
    for (int i = 0; i < requests; ++i) {
      const Duration rest = learning.next_pause() + 1ms;
      ++asked;
      learning.tried(rest, rest > deaf);
      if (rest > deaf) continue;
      ++failed;
      learning.tried(rest + learning.next_pause() + 200ms, true);  // the retry
    }
  }
};

// Simulates a dead device: no rest of up to a second gets a response.
void learn_a_second(PauseLearning& learning) {
  for (int i = 0; i < 12; ++i) learning.tried(5s, true);
  for (int i = 0; i < 12; ++i) learning.tried(800ms, false);
}

TEST(PauseLearning, APauseThatIsNotNeededBecomesShorterAndGoes) {
  for (const Duration deaf : {Duration{-1}, Duration{30ms}, Duration{180ms}}) {
    PauseLearning learning;
    learn_a_second(learning);
    ASSERT_EQ(learning.pause(), 1s);
    DeafDevice device{deaf, learning};
    device.ask(400);
    EXPECT_GE(learning.pause() + 1ms, deaf);
    EXPECT_LE(learning.pause(), std::max(Duration{}, 2 * deaf)) << to_text(deaf);
    EXPECT_LE(device.failed, 10);
  }
}

TEST(PauseLearning, APauseThatIsNeededIsPutOnTrialEverMoreRarely) {
  PauseLearning learning;
  learn_a_second(learning);
  DeafDevice device{900ms, learning};
  device.ask(100'000);
  EXPECT_EQ(learning.pause(), 1s);
  EXPECT_LE(device.failed, 40);
  const int before = device.failed;
  device.ask(10'000);
  EXPECT_LE(device.failed - before, 4);
}

TEST(PauseLearning, AfterARequestThatFailedTheWholePauseIsKeptForAWhile) {
  PauseLearning learning;
  learn_a_second(learning);
  for (unsigned i = 1; i < PauseLearning::kFirstTrial; ++i) learning.tried(1s, true);
  EXPECT_EQ(learning.next_pause(), 1s);
  learning.tried(1s, true);
  ASSERT_EQ(learning.next_pause(), 700ms);
  learning.tried(700ms, false);
  for (int i = 0; i < 8; ++i) {
    EXPECT_EQ(learning.next_pause(), 1s);
    learning.tried(1s, true);
  }
  EXPECT_EQ(learning.next_pause(), 700ms);
}

TEST(PauseLearning, ATestFailsWhenMostOfItsRequestsHaveNoResponse) {
  PauseLearning learning;
  learn_a_second(learning);
  for (unsigned i = 0; i < PauseLearning::kFirstTrial; ++i) learning.tried(1s, true);
  const auto lose_one = [&] {
    learning.tried(700ms, false);
    for (int i = 0; i < 8; ++i) learning.tried(1s, true);
  };
  for (int i = 0; i < 2; ++i) learning.tried(700ms, true);
  lose_one();
  EXPECT_EQ(learning.next_pause(), 700ms);
  lose_one();
  EXPECT_EQ(learning.next_pause(), 700ms) << "two of four";
  lose_one();
  EXPECT_EQ(learning.next_pause(), 1s) << "three of five";
}

}  // namespace
}  // namespace fieldcast
