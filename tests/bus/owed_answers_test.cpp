#include "core/bus/wire/owed_answers.hpp"

#include <gtest/gtest.h>

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

// Reads of one area: responses of the same device and length look equal, as in Modbus RTU.
OwedAnswers alike_by_length() {
  return OwedAnswers([](const Asked& a, const Asked& b) {
    const auto count = [](const Asked& asked) {
      return std::get<ReadRequest>(asked.request).ranges[0].count;
    };
    return a.device == b.device && count(a) == count(b);
  });
}

Asked read(DeviceIndex device, std::uint32_t first, std::uint32_t count, Instant sent = {}) {
  return {device, ReadRequest{{{0, first, count}}}, {}, sent};
}

void owe(OwedAnswers& owed, Asked asked) {
  OwedAnswers::Debt debt;
  debt.asked = std::move(asked);
  debt.bound = 600ms;
  owed.owe(std::move(debt));
}

TEST(OwedAnswers, WhatCouldBeMistakenWaitsForTheBound) {
  OwedAnswers owed = alike_by_length();
  owe(owed, read(1, 100, 2));
  EXPECT_EQ(owed.askable_from(read(1, 200, 2), true), Instant{600ms});
  EXPECT_EQ(owed.askable_from(read(1, 200, 3), true), kLongAgo) << "another length";
  EXPECT_EQ(owed.askable_from(read(2, 200, 2), true), kLongAgo) << "another device";
  EXPECT_EQ(owed.askable_from(read(1, 100, 2), true), kLongAgo) << "the same again";
  EXPECT_EQ(owed.askable_from(read(1, 100, 2), false), Instant{600ms}) << "a command's";
}

TEST(OwedAnswers, AskedTwiceAndAnsweredOnceOwesOne) {
  OwedAnswers owed = alike_by_length();
  owe(owed, read(1, 100, 2));
  owed.answered(read(1, 100, 2, Instant{200ms}), false, 600ms, Instant{250ms});
  ASSERT_EQ(owed.debts().size(), 1u);
  EXPECT_EQ(owed.askable_from(read(1, 200, 2), true), Instant{800ms});
  (void)owed.take(0, Instant{300ms});
  EXPECT_EQ(owed.askable_from(read(1, 200, 2), true), kLongAgo);
}

TEST(OwedAnswers, OneAfterTheOtherIsWorkedOff) {
  OwedAnswers owed = alike_by_length();
  owe(owed, read(1, 100, 2));
  owe(owed, read(1, 100, 2, Instant{200ms}));
  EXPECT_EQ(owed.askable_from(read(1, 200, 2), true), Instant{1200ms});
  (void)owed.take(0, Instant{250ms});
  EXPECT_EQ(owed.askable_from(read(1, 200, 2), true), Instant{850ms});
  EXPECT_FALSE(owed.expire(Instant{849ms}));
  EXPECT_TRUE(owed.expire(Instant{850ms}));
}

TEST(OwedAnswers, AnAnswerThatIsCertainEndsWhatWasAskedBefore) {
  OwedAnswers owed = alike_by_length();
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
