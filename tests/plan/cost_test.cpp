#include "core/plan/layout/cost.hpp"

#include <gtest/gtest.h>

#include "tests/plan/fake_protocol.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using test::kBits, test::kBytewise, test::kRegisters, test::kWindow;

using test::kFakeProtocol;
const LineFormat kLine{9600, 8, Parity::kNone, 1};  // 10 bits: 1.0417 ms per character

DeviceTiming timing() {
  DeviceTiming device;
  device.protocol = &kFakeProtocol;
  device.answer_time = 2ms;
  return device;
}

TEST(ReadCost, IsTheExactWireTimeOfEveryLength) {
  DeviceTiming device = timing();
  device.pause = 7ms;
  const ReadCost cost(device, kRegisters, kLine, 3ms, 125);
  for (std::uint32_t count : {1u, 2u, 60u, 125u}) {
    const Range range{kRegisters, 10, count};
    ASSERT_TRUE(cost.fits(range));
    EXPECT_EQ(cost.of(range), kLine.characters(13 + 2 * count) + 2ms + 3ms + 7ms) << count;
  }
  EXPECT_FALSE(cost.fits({kRegisters, 0, 126}));
}

TEST(ReadCost, BitsCostNothingWithinAByte) {
  const ReadCost cost(timing(), kBits, kLine, 3ms, 2000);
  EXPECT_EQ(cost.of({kBits, 0, 1}), cost.of({kBits, 3, 8}));
  EXPECT_EQ(cost.of({kBits, 0, 9}) - cost.of({kBits, 0, 8}),
            kLine.characters(14 + 1) - kLine.characters(14));
}

TEST(ReadCost, AlignedAreasAreReadByWholeUnits) {
  const ReadCost cost(timing(), kBytewise, kLine, 3ms, 100);
  EXPECT_EQ(cost.cover(13, 15), (Range{kBytewise, 8, 8}));
  EXPECT_EQ(cost.cover(7, 17), (Range{kBytewise, 0, 24}));
}

TEST(ReadCost, OnePointAcrossTwoUnitsIsReadable) {
  const ReadCost cost(timing(), kBytewise, kLine, 3ms, 2);
  EXPECT_TRUE(cost.of_single(cost.cover(7, 9)));
}

TEST(ReadCost, WindowsAreReadWhole) {
  const ReadCost cost(timing(), kWindow, kLine, 3ms, 1);
  EXPECT_EQ(cost.cover(20, 22), (Range{kWindow, 0, 64}));
  EXPECT_TRUE(cost.fits({kWindow, 0, 64}));
  EXPECT_EQ(cost.of({kWindow, 0, 64}), kLine.characters(13 + 64) + 5ms);
}

TEST(ReadCost, BridgeEndsWhereAnotherRequestIsCheaper) {
  const ReadCost cost(timing(), kRegisters, kLine, 3ms, 125);
  const Duration one = cost.of({kRegisters, 0, 1});
  const std::uint32_t gap = cost.bridge();
  EXPECT_LE(cost.of({kRegisters, 0, gap + 2}), 2 * one);
  EXPECT_GT(cost.of({kRegisters, 0, gap + 3}), 2 * one);
}

TEST(ReadCost, SlowerDevicesBridgeMoreButNeverBeyondTheirLimit) {
  DeviceTiming device = timing();
  ReadCost cost(device, kRegisters, kLine, 3ms, 125);
  const std::uint32_t before = cost.bridge();
  cost.set_answer_time(40ms);
  EXPECT_GT(cost.bridge(), before);
  device.max_gap = 4;
  ReadCost limited(device, kRegisters, kLine, 3ms, 125);
  limited.set_answer_time(40ms);
  EXPECT_EQ(limited.bridge(), 4u);
}

TEST(ReadCost, DeviceLimitHoldsForBlocksAndNotForSinglePoints) {
  DeviceTiming device = timing();
  device.max_block = 8;
  const ReadCost cost(device, kRegisters, kLine, 3ms, 100);
  EXPECT_FALSE(cost.fits({kRegisters, 0, 9}));
  EXPECT_TRUE(cost.of_single({kRegisters, 0, 9}));
  EXPECT_FALSE(cost.of_single({kRegisters, 0, 126}));
}

}  // namespace
}  // namespace fieldcast
