#include "tools/forward/outlet/mqtt/deliveries.hpp"

#include <gtest/gtest.h>

namespace fieldcast::forward {
namespace {

constexpr Instant at(int seconds) { return Instant{std::chrono::seconds{seconds}}; }

struct DeliveriesTest : testing::Test {
  Deliveries deliveries;
  std::vector<OutletResult> results;

  void acknowledge(int message, Outcome outcome = Outcome::kAcknowledged) {
    deliveries.acknowledge(message, outcome, results);
  }
};

TEST_F(DeliveriesTest, ARecordIsAcknowledgedWithTheLastOfItsMessages) {
  deliveries.begin(7);
  deliveries.add(7, 1, at(0));
  deliveries.add(7, 2, at(0));
  acknowledge(2);
  acknowledge(1);
  EXPECT_TRUE(results.empty()) << "further messages of the record may follow";
  deliveries.end(7, results);
  ASSERT_EQ(results.size(), 1u);
  EXPECT_EQ(results[0].record, 7u);
  EXPECT_EQ(results[0].outcome, Outcome::kAcknowledged);
  acknowledge(1);
  EXPECT_EQ(results.size(), 1u) << "a second acknowledgement of a message is ignored";
}

TEST_F(DeliveriesTest, OneMessageMayConfirmSeveralRecords) {
  for (const std::uint64_t record : {3, 4}) {
    deliveries.begin(record);
    deliveries.add(record, 9, at(0));
    deliveries.end(record, results);
  }
  acknowledge(9);
  EXPECT_EQ(results.size(), 2u);
}

TEST_F(DeliveriesTest, ARefusedMessageRefusesItsRecordAfterTheOthers) {
  deliveries.begin(7);
  deliveries.add(7, 1, at(0));
  deliveries.refuse(7);
  deliveries.add(7, 2, at(0));
  deliveries.end(7, results);
  acknowledge(1);
  EXPECT_TRUE(results.empty());
  acknowledge(2, Outcome::kRefused);
  ASSERT_EQ(results.size(), 1u);
  EXPECT_EQ(results[0].outcome, Outcome::kRefused);
}

TEST_F(DeliveriesTest, TheOldestMessageIsThatWithoutAnAcknowledgement) {
  EXPECT_FALSE(deliveries.oldest());
  deliveries.add(1, 1, at(1));
  deliveries.add(1, 2, at(2));
  deliveries.add(1, 3, at(3));
  EXPECT_EQ(deliveries.oldest(), at(1));
  acknowledge(2);
  EXPECT_EQ(deliveries.oldest(), at(1));
  acknowledge(1);
  EXPECT_EQ(deliveries.oldest(), at(3));
  deliveries.add(2, 1, at(4));  // ids are used again
  acknowledge(3);
  EXPECT_EQ(deliveries.oldest(), at(4));
}

TEST_F(DeliveriesTest, ALostConnectionFailsAllRecords) {
  deliveries.begin(7);
  deliveries.add(7, 1, at(0));
  deliveries.begin(8);
  deliveries.fail_all(results);
  ASSERT_EQ(results.size(), 2u);
  EXPECT_EQ(results[0].outcome, Outcome::kFailed);
  acknowledge(1);
  EXPECT_EQ(results.size(), 2u);
  EXPECT_EQ(deliveries.messages(), 0u);
}

}  // namespace
}  // namespace fieldcast::forward
