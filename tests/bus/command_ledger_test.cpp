#include "core/bus/command/command_ledger.hpp"

#include <gtest/gtest.h>

namespace fieldcast {
namespace {

TEST(CommandLedger, TheSecondOfAKeyIsADuplicate) {
  CommandLedger ledger;
  EXPECT_TRUE(ledger.enter("press", 1));
  EXPECT_FALSE(ledger.enter("press", 1));
  EXPECT_FALSE(ledger.enter("press", 1));
}

TEST(CommandLedger, RequesterAndIdAreTheKeyTogether) {
  CommandLedger ledger;
  EXPECT_TRUE(ledger.enter("a", 1));
  EXPECT_TRUE(ledger.enter("a", 2));
  EXPECT_TRUE(ledger.enter("b", 1));
}

TEST(CommandLedger, MemoryIsBoundedAndTheOldestIsForgotten) {
  CommandLedger ledger(3);
  for (std::uint64_t id = 1; id <= 4; ++id) EXPECT_TRUE(ledger.enter("a", id));
  EXPECT_EQ(ledger.size(), 3u);
  EXPECT_FALSE(ledger.enter("a", 2));
  EXPECT_FALSE(ledger.enter("a", 4));
  EXPECT_TRUE(ledger.enter("a", 1));
}

TEST(CommandLedger, MillionsOfCommandsLeaveNothingBehindButTheLast) {
  CommandLedger ledger(1000);
  for (std::uint64_t id = 0; id < 100'000; ++id) ASSERT_TRUE(ledger.enter("plant", id));
  EXPECT_EQ(ledger.size(), 1000u);
  for (std::uint64_t id = 99'000; id < 100'000; ++id) ASSERT_FALSE(ledger.enter("plant", id));
}

}  // namespace
}  // namespace fieldcast
