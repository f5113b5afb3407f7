#include <gtest/gtest.h>

#include "bridge/publish/publisher_thread.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

constexpr Instant kNow{std::chrono::hours{1}};

Sample sample_of(ChannelIndex channel, Quality quality, std::uint64_t sequence) {
  Sample sample;
  sample.channel = channel;
  sample.quality = quality;
  sample.sequence = sequence;
  sample.acquired = kNow;
  return sample;
}

std::vector<std::uint64_t> sequences(const std::vector<Sample>& samples) {
  std::vector<std::uint64_t> all;
  for (const Sample& sample : samples) all.push_back(sample.sequence);
  return all;
}

using Sequences = std::vector<std::uint64_t>;

TEST(SampleHold, LetsEverythingPassImmediatelyWhereNothingSpeaksAgainstIt) {
  SampleHold hold;
  EXPECT_EQ(sequences(hold.pass({sample_of(1, Quality::kBadNoResponse, 7)}, true, kNow)),
            Sequences{7});
}

TEST(SampleHold, WhatStayedWhileAnotherMasterHadTheWireLeavesWithTheFirstGoodValue) {
  SampleHold hold;
  hold.foreign_master(kNow - 1ms);
  EXPECT_TRUE(hold.pass({sample_of(1, Quality::kUncertain, 7)}, true, kNow).empty());
  EXPECT_TRUE(hold.pass({sample_of(2, Quality::kUncertain, 8)}, true, kNow).empty());
  EXPECT_TRUE(hold.pass({sample_of(1, Quality::kBadNoResponse, 9)}, true, kNow).empty());
  EXPECT_EQ(sequences(hold.pass({sample_of(2, Quality::kGood, 10)}, true, kNow)),
            (Sequences{9, 10}));
  EXPECT_EQ(sequences(hold.pass({}, true, kNow)), Sequences{});
}

TEST(SampleHold, AfterATakeoverBadValuesWaitForTheFirstGoodOneOrForTheirTime) {
  SampleHold hold;
  hold.prove_until(kNow + 3s, kNow - 1ms);
  EXPECT_TRUE(hold.pass({sample_of(1, Quality::kBadNoResponse, 7)}, true, kNow).empty());
  EXPECT_TRUE(hold.pass({}, true, kNow + 2s).empty());
  EXPECT_EQ(sequences(hold.pass({}, true, kNow + 3s)), Sequences{7});
}

TEST(SampleHold, AGoodValueOfBeforeProvesNothing) {
  SampleHold hold;
  hold.foreign_master(kNow);
  EXPECT_TRUE(hold.pass({sample_of(1, Quality::kGood, 7)}, true, kNow + 1ms).empty());
  Sample fresh = sample_of(2, Quality::kGood, 8);
  fresh.acquired = kNow + 2ms;
  EXPECT_EQ(sequences(hold.pass({fresh}, true, kNow + 2ms)), (Sequences{7, 8}));
}

TEST(SampleHold, WhoIsInDoubtWhetherItIsMasterPublishesNothingBeforeItKnows) {
  SampleHold hold;
  EXPECT_TRUE(hold.pass({sample_of(1, Quality::kGood, 7)}, false, kNow).empty());
  EXPECT_EQ(sequences(hold.pass({sample_of(2, Quality::kGood, 8)}, true, kNow)), (Sequences{7, 8}));
}

}  // namespace
}  // namespace fieldcast
