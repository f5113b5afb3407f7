#include "core/bus/wire/pending_responses.hpp"

#include <gtest/gtest.h>

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

// Reads of one area: responses of the same device and length look equal, as in Modbus RTU.
PendingResponses alike_by_length() {
  return PendingResponses([](const Asked& a, const Asked& b) {
    const auto count = [](const Asked& asked) {
      return std::get<ReadRequest>(asked.request).ranges[0].count;
    };
    return a.device == b.device && count(a) == count(b);
  });
}

Asked read(DeviceIndex device, std::uint32_t first, std::uint32_t count, Instant sent = {}) {
  return {device, ReadRequest{{{0, first, count}}}, {}, sent};
}

void owe(PendingResponses& owed, Asked asked) {
  PendingResponses::Debt debt;
  debt.asked = std::move(asked);
  debt.bound = 600ms;
  owed.owe(std::move(debt));
}

TEST(PendingResponses, WhatCouldBeMistakenWaitsForTheBound) {
  PendingResponses owed = alike_by_length();
  owe(owed, read(1, 100, 2));
  EXPECT_EQ(owed.askable_from(read(1, 200, 2), true), Instant{600ms});
  EXPECT_EQ(owed.askable_from(read(1, 200, 3), true), kLongAgo) << "another length";
  EXPECT_EQ(owed.askable_from(read(2, 200, 2), true), kLongAgo) << "another device";
  EXPECT_EQ(owed.askable_from(read(1, 100, 2), true), kLongAgo) << "the same again";
  EXPECT_EQ(owed.askable_from(read(1, 100, 2), false), Instant{600ms}) << "a command's";
}

TEST(PendingResponses, AskedTwiceAndAnsweredOnceOwesOne) {
  PendingResponses owed = alike_by_length();
  owe(owed, read(1, 100, 2));
  owed.answered(read(1, 100, 2, Instant{200ms}), false, 600ms, Instant{250ms});
  ASSERT_EQ(owed.debts().size(), 1u);
  EXPECT_EQ(owed.askable_from(read(1, 200, 2), true), Instant{800ms});
  (void)owed.take(0, Instant{300ms});
  EXPECT_EQ(owed.askable_from(read(1, 200, 2), true), kLongAgo);
}

TEST(PendingResponses, OneAfterTheOtherIsWorkedOff) {
  PendingResponses owed = alike_by_length();
  owe(owed, read(1, 100, 2));
  owe(owed, read(1, 100, 2, Instant{200ms}));
  EXPECT_EQ(owed.askable_from(read(1, 200, 2), true), Instant{1200ms});
  (void)owed.take(0, Instant{250ms});
  EXPECT_EQ(owed.askable_from(read(1, 200, 2), true), Instant{850ms});
  EXPECT_FALSE(owed.expire(Instant{849ms}));
  EXPECT_TRUE(owed.expire(Instant{850ms}));
}

TEST(PendingResponses, AnAnswerThatIsCertainEndsWhatWasAskedBefore) {
  PendingResponses owed = alike_by_length();
  owe(owed, read(1, 100, 2));
  owe(owed, read(2, 100, 2));
  owed.answered(read(1, 100, 3, Instant{200ms}), true, 600ms, Instant{210ms});
  EXPECT_EQ(owed.debts().size(), 2u) << "a refusal shows nothing of its length";
  owed.answered(read(1, 100, 3, Instant{200ms}), false, 600ms, Instant{210ms});
  ASSERT_EQ(owed.debts().size(), 1u);
  EXPECT_EQ(owed.debts()[0].asked.device, 2u);
}

}  // namespace
}  // namespace fieldcast
