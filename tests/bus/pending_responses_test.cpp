#include "core/bus/wire/pending_responses.hpp"

#include <gtest/gtest.h>

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

// Registers of the same hundred have responses that are alike.
class PendingResponsesTest : public testing::Test {
 protected:
  static std::uint32_t first_of(const Asked& asked) {
    return std::get<ReadRequest>(asked.request).ranges[0].first;
  }
  static Asked asked(std::uint32_t first, Duration sent, DeviceIndex device = 0) {
    return {device, ReadRequest{{{0, first, 1}}}, {}, Instant{sent}};
  }
  void owe(const Asked& asked) {
    PendingResponses::Debt debt;
    debt.asked = asked;
    debt.bound = 100ms;
    pending_.owe(std::move(debt));
  }
  std::vector<std::uint32_t> owed() {
    std::vector<std::uint32_t> all;
    for (const auto& debt : pending_.debts()) all.push_back(first_of(debt.asked));
    return all;
  }
  std::vector<Instant> ends() {
    std::vector<Instant> all;
    for (const auto& debt : pending_.debts()) all.push_back(debt.until());
    return all;
  }
  using Registers = std::vector<std::uint32_t>;
  using Ends = std::vector<Instant>;

  PendingResponses pending_{[](const Asked& earlier, const Asked& later) {
    return earlier.device == later.device && first_of(earlier) / 100 == first_of(later) / 100;
  }};
};

TEST_F(PendingResponsesTest, ADebtEndsAfterItsTime) {
  owe(asked(1, 10ms));
  EXPECT_TRUE(pending_.owes(0));
  EXPECT_FALSE(pending_.owes(1));
  EXPECT_FALSE(pending_.expire(Instant{110ms - 1ns}));
  EXPECT_TRUE(pending_.expire(Instant{110ms}));
  EXPECT_TRUE(pending_.empty());
}

// A device handles its requests one by one; a debt waits for at most two others.
TEST_F(PendingResponsesTest, TheTimeOfADebtBeginsWhenThePreviousOneOfTheDeviceEnds) {
  for (const Duration sent : {0ms, 10ms, 20ms, 30ms}) owe(asked(1, sent));
  owe(asked(1, 5ms, 1));
  EXPECT_EQ(ends(),
            (Ends{Instant{100ms}, Instant{200ms}, Instant{300ms}, Instant{330ms}, Instant{105ms}}));
  EXPECT_EQ(pending_.until(), Instant{330ms});
}

TEST_F(PendingResponsesTest, WhenAResponseArrivesTheNextDebtBegins) {
  for (const Duration sent : {0ms, 10ms, 20ms}) owe(asked(1, sent));
  owe(asked(1, 5ms, 1));
  EXPECT_EQ(pending_.take(0, Instant{50ms}).asked.sent_until, Instant{});
  EXPECT_EQ(ends(), (Ends{Instant{150ms}, Instant{250ms}, Instant{105ms}}));
}

// The device has passed them by: it responds in the order of the requests.
TEST_F(PendingResponsesTest, ALateResponseSettlesEarlierDebtsThatItCannotBe) {
  owe(asked(1, 0ms));
  owe(asked(200, 1ms));
  owe(asked(200, 2ms, 1));
  owe(asked(2, 3ms));
  owe(asked(300, 4ms));
  EXPECT_EQ(first_of(pending_.take(3, Instant{50ms}).asked), 2u);
  EXPECT_EQ(owed(), (Registers{1, 200, 300}));
  EXPECT_EQ(pending_.debts()[1].asked.device, 1);
}

TEST_F(PendingResponsesTest, AResponseThatCannotBeConfusedSettlesAllDebtsOfItsDevice) {
  owe(asked(1, 0ms));
  owe(asked(2, 1ms));
  owe(asked(1, 2ms, 1));
  pending_.responded(asked(500, 3ms), true, 100ms, Instant{50ms});
  EXPECT_EQ(owed().size(), 3u) << "a refusal identifies its request less";
  pending_.responded(asked(500, 3ms), false, 100ms, Instant{50ms});
  ASSERT_EQ(owed().size(), 1u);
  EXPECT_FALSE(pending_.owes(0));
}

// The response may be the one to the earlier request; then the one to this request is pending.
TEST_F(PendingResponsesTest, AResponseThatCouldBeConfusedReplacesTheOldestDebt) {
  owe(asked(1, 10ms));
  owe(asked(2, 20ms));
  pending_.responded(asked(3, 30ms), true, 70ms, Instant{50ms});
  EXPECT_EQ(owed(), (Registers{2, 3}));
  EXPECT_EQ(ends(), (Ends{Instant{150ms}, Instant{220ms}}));
  const PendingResponses::Debt& own = pending_.debts()[1];
  EXPECT_EQ(own.before, 40ms) << "the time of the response, if it was that of the earlier request";
  EXPECT_FALSE(own.no_response);
}

TEST_F(PendingResponsesTest, TheSameReadMayBeRepeatedUntilOneHasItsResponse) {
  owe(asked(1, 0ms));
  owe(asked(1, 10ms));
  EXPECT_TRUE(pending_.owes_same(asked(1, 20ms)));
  EXPECT_FALSE(pending_.owes_same(asked(2, 20ms)));
  EXPECT_FALSE(pending_.owes_same(asked(1, 20ms, 1)));
  EXPECT_EQ(pending_.askable_from(asked(1, 20ms), true), kLongAgo);
  EXPECT_EQ(pending_.askable_from(asked(1, 20ms), false), Instant{200ms});
  EXPECT_EQ(pending_.askable_from(asked(2, 20ms), true), Instant{200ms});
  EXPECT_EQ(pending_.askable_from(asked(200, 20ms), true), kLongAgo);
  EXPECT_EQ(pending_.askable_from(asked(1, 20ms, 1), true), kLongAgo);
  pending_.responded(asked(1, 20ms), false, 100ms, Instant{50ms});
  EXPECT_EQ(owed().size(), 2u) << "asked three times, and one response";
  EXPECT_EQ(pending_.askable_from(asked(1, 60ms), true), pending_.until());
}

TEST_F(PendingResponsesTest, TheOldestOfTooManyIsDropped) {
  for (std::uint32_t i = 0; i < PendingResponses::kMost; ++i) owe(asked(i, 0ms));
  EXPECT_EQ(owed().size(), PendingResponses::kMost);
  EXPECT_EQ(owed().front(), 0u);
  owe(asked(1000, 1ms));
  EXPECT_EQ(owed().size(), PendingResponses::kMost);
  EXPECT_EQ(owed().front(), 1u);
  EXPECT_EQ(owed().back(), 1000u);
}

}  // namespace
}  // namespace fieldcast
