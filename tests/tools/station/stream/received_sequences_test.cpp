#include "tools/station/stream/received_sequences.hpp"

#include <gtest/gtest.h>

namespace fieldcast::web {
namespace {

TEST(ReceivedSequences, LateOnesFillTheGapAndAreThenDuplicates) {
  ReceivedSequences received;
  EXPECT_TRUE(received.add(1, 1));
  EXPECT_TRUE(received.add(1, 2));
  EXPECT_TRUE(received.add(1, 6));
  EXPECT_TRUE(received.add(1, 7));
  EXPECT_FALSE(received.add(1, 6));
  EXPECT_TRUE(received.add(1, 4));
  EXPECT_TRUE(received.add(1, 3));
  EXPECT_TRUE(received.add(1, 5));
  for (std::uint64_t sequence = 1; sequence <= 7; ++sequence)
    EXPECT_FALSE(received.add(1, sequence)) << sequence;
  EXPECT_TRUE(received.add(1, 8));
}

TEST(ReceivedSequences, ANewEpochBeginsAgain) {
  ReceivedSequences received;
  EXPECT_TRUE(received.add(1, 1));
  EXPECT_TRUE(received.add(2, 1));
  EXPECT_FALSE(received.add(2, 1));
}

TEST(ReceivedSequences, AnEarlierEpochIsAlwaysAccepted) {
  ReceivedSequences received;
  EXPECT_TRUE(received.add(2, 1));
  EXPECT_TRUE(received.add(1, 1));
  EXPECT_TRUE(received.add(1, 1));
  EXPECT_FALSE(received.add(2, 1));
}

TEST(ReceivedSequences, TheOldestRunIsForgottenBeyondTheLimit) {
  ReceivedSequences received;
  for (std::uint64_t i = 0; i <= ReceivedSequences::kMaxRuns; ++i)
    EXPECT_TRUE(received.add(1, 1 + 2 * i));
  EXPECT_TRUE(received.add(1, 1));
  EXPECT_FALSE(received.add(1, 1 + 2 * ReceivedSequences::kMaxRuns));
}

}  // namespace
}  // namespace fieldcast::web
