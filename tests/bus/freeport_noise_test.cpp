// A short, seeded run of tools/bench/freeport_bench.
#include <gtest/gtest.h>

#include "tests/bus/freeport_bus.hpp"
#include "tests/bus/freeport_pairs.hpp"

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

TEST(FreeportNoise, ACleanLinePublishesEveryValueAsItIs) {
  FreeportBus bus(8, 0, 1, 5ms);
  bus.run(20'000);
  EXPECT_EQ(bus.counts().right, 20'000u);
  EXPECT_EQ(bus.counts().wrong, 0u);
  EXPECT_EQ(bus.counts().bad, 0u);
  EXPECT_EQ(bus.causes().total(), 0u);
}

TEST(FreeportNoise, ANoisyLineFailsAsOftenAsItsBitsSay) {
  FreeportBus bus(8, 1e-4, 2, 5ms);
  bus.run(200'000);
  EXPECT_EQ(bus.counts().wrong, 0u);  // expected 0.7 in a million; none with this seed
  const double failed = static_cast<double>(bus.causes().total()) / 200'000;
  EXPECT_GT(failed, 0.02);  // 290 bits: 0.0286 of the exchanges have an error
  EXPECT_LT(failed, 0.03);
  EXPECT_GT(bus.counts().right, 190'000u);
}

TEST(FreeportNoise, NoPairOfErrorsPassesThatTheCheckCouldSee) {
  const FreeportPairs pairs = count_freeport_pairs(8, 64, 3);
  EXPECT_EQ(pairs.single, 0u);
  EXPECT_GT(pairs.check_allows, 40);
  EXPECT_DOUBLE_EQ(pairs.taken, pairs.check_allows);
  EXPECT_LE(wrong_share(pairs.taken + pairs.misled, 1e-4), 1e-6);
}

TEST(NoisyUart, ALowStopBitIsTheNextStartBit) {
  std::vector<bool> levels = line_levels(Bytes{0x41, 0x42});
  ASSERT_EQ(uart_received(levels), (Bytes{0x41, 0x42}));
  levels[19] = false;  // stop bit of the first: the rest is shifted by one bit
  EXPECT_EQ(uart_received(levels), (Bytes{0x41, 0x84, 0xFF}));
  levels[19] = true;
  levels[10] = true;  // start bit of the first: its second data bit is the first low bit
  EXPECT_EQ(uart_received(levels), (Bytes{0x50, 0xA1}));
}

}  // namespace
}  // namespace fieldcast::test
