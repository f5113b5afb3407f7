#include "tools/forward/batch/thinning.hpp"

#include <gtest/gtest.h>

#include "tests/tools/forward/batch_support.hpp"

namespace fieldcast::forward {
namespace {

TEST(Thinning, KeepsTheFirstSampleOfEachMinute) {
  Thinning thinning;
  SampleBatch batch = seconds(0, 150);
  EXPECT_EQ(thinning.thin(batch), 147u);
  ASSERT_EQ(batch.samples.size(), 3u);
  EXPECT_EQ(batch.samples[0].sequence, 1u);
  EXPECT_EQ(batch.samples[1].sequence, 61u);
  EXPECT_EQ(batch.samples[2].sequence, 121u);
}

TEST(Thinning, AMinuteContinuesInTheNextBatch) {
  Thinning thinning;
  SampleBatch first = seconds(0, 30), second = seconds(30, 90);
  EXPECT_EQ(thinning.thin(first), 29u);
  EXPECT_EQ(thinning.thin(second), 59u);
  EXPECT_EQ(second.samples.at(0).sequence, 61u);
}

TEST(Thinning, EachChannelKeepsItsOwn) {
  Thinning thinning;
  SampleBatch batch = seconds(0, 2);
  batch.samples[1].channel = 1;
  EXPECT_EQ(thinning.thin(batch), 0u);
}

TEST(Thinning, AClockThatWasSetBackLosesNoMinute) {
  Thinning thinning;
  SampleBatch before = seconds(600, 601), after = seconds(0, 61);
  EXPECT_EQ(thinning.thin(before), 0u);
  EXPECT_EQ(thinning.thin(after), 59u);
}

}  // namespace
}  // namespace fieldcast::forward
