#include "tools/sim/bus/wire.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

namespace fieldcast::sim {
namespace {

using namespace std::chrono_literals;
constexpr Instant kBegin{1s};

WireOptions at_9600() {
  WireOptions options;
  options.line = {9600, 8, Parity::kNone, 1};  // ten bits: 1041666 ns per character
  return options;
}

struct Arrived {
  Bytes bytes;
  std::vector<std::pair<Instant, std::size_t>> pieces;  // time and number of bytes by then
};

// Runs the wire until it is idle and wakes it at its requested times.
Arrived run(Wire& wire, Sender from) {
  Arrived arrived;
  while (wire.next_due() != kNever) {
    const Instant now = wire.next_due();
    while (const auto passed = wire.advance(now)) {
      if (passed->sender != from) continue;
      append(arrived.bytes, passed->characters);
      arrived.pieces.emplace_back(now, arrived.bytes.size());
    }
  }
  return arrived;
}

TEST(Wire, ARequestTakesTheTimeOfItsCharacters) {
  Wire wire(at_9600());
  wire.from_master(Bytes(8, 0x55), kBegin);
  EXPECT_EQ(wire.next_due(), kBegin + 8 * 1041667ns);
  EXPECT_FALSE(wire.advance(kBegin + 1041666ns));
  std::size_t received = 0;
  while (wire.advance(kBegin + 8 * 1041667ns)) ++received;
  EXPECT_EQ(received, 8u);
  EXPECT_TRUE(wire.at_rest());
}

TEST(Wire, PiecesOfTheMasterFollowEachOther) {
  Wire wire(at_9600());
  wire.from_master(Bytes(4, 1), kBegin);
  wire.from_master(Bytes(4, 2), kBegin + 1us);
  const Arrived received = run(wire, kMaster);
  EXPECT_EQ(received.bytes.size(), 8u);
  EXPECT_EQ(received.pieces.back().first, kBegin + 8 * 1041667ns);
}

TEST(Wire, ResponseComesInFifoPiecesAndEndsOnTheInstant) {
  Wire wire(at_9600());
  Bytes answer(21);
  for (std::size_t i = 0; i < answer.size(); ++i) answer[i] = static_cast<std::uint8_t>(i);
  wire.from_device(0, answer, kBegin);
  const Arrived arrived = run(wire, 0);
  EXPECT_EQ(arrived.bytes, answer);
  const std::vector<std::pair<Instant, std::size_t>> pieces{
      {kBegin + 8 * 1041667ns, 8}, {kBegin + 16 * 1041667ns, 16}, {kBegin + 21 * 1041667ns, 21}};
  EXPECT_EQ(arrived.pieces, pieces);
}

TEST(Wire, ALateWakeUpDoesNotMoveWhatFollows) {
  Wire wire(at_9600());
  wire.from_device(0, Bytes(16, 7), kBegin);
  const Instant late = wire.next_due() + 5ms;
  ASSERT_TRUE(wire.advance(late));
  EXPECT_EQ(wire.next_due(), kBegin + 16 * 1041667ns);
}

TEST(Wire, TalkingIntoAResponseGarblesBoth) {
  Wire wire(at_9600());
  wire.from_device(0, Bytes(10, 0x11), kBegin);
  wire.from_master(Bytes(4, 0x22), kBegin + 5200us);  // from the sixth to the ninth character
  Bytes from_device, from_master;
  while (wire.next_due() != kNever) {
    while (const auto passed = wire.advance(wire.next_due()))
      append(passed->sender == 0 ? from_device : from_master, passed->characters);
  }
  ASSERT_EQ(from_device.size(), 10u);
  ASSERT_EQ(from_master.size(), 4u);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(from_device[i] == 0x11, i < 4 || i > 8) << i;
  for (const std::uint8_t character : from_master) EXPECT_NE(character, 0x22);
  EXPECT_GT(wire.collisions(), 0u);
}

TEST(Wire, FullDuplexLinesDoNotCollide) {
  WireOptions options = at_9600();
  options.half_duplex = false;
  Wire wire(options);
  wire.from_device(0, Bytes(10, 0x11), kBegin);
  wire.from_master(Bytes(4, 0x22), kBegin);
  EXPECT_EQ(run(wire, 0).bytes, Bytes(10, 0x11));
  EXPECT_EQ(wire.collisions(), 0u);
}

TEST(Wire, EchoGivesBackWhatTheMasterSaid) {
  WireOptions options = at_9600();
  options.echo = true;
  Wire wire(options);
  wire.from_master(Bytes{1, 2, 3}, kBegin);
  EXPECT_EQ(run(wire, kEcho).bytes, (Bytes{1, 2, 3}));
}

TEST(Wire, AMasterThatNeverStopsLosesCharacters) {
  Wire wire(at_9600());
  wire.from_master(Bytes(Wire::kMaxQueued, 0), kBegin);
  wire.from_master(Bytes(100, 0), kBegin);
  EXPECT_EQ(wire.lost(), 100u);
}

TEST(Wire, KnowsTheShortestRestOfTheMaster) {
  Wire wire(at_9600());
  wire.from_master(Bytes(8, 0), kBegin);
  while (wire.advance(kBegin + 1s)) {}
  EXPECT_FALSE(wire.shortest_rest());
  wire.from_device(0, Bytes(8, 0), kBegin + 20ms);
  run(wire, 0);
  const Instant end = kBegin + 20ms + 8 * 1041667ns;
  wire.from_master(Bytes(8, 0), end + 4ms);
  EXPECT_EQ(wire.shortest_rest(), Duration{4ms});
}

TEST(BitNoise, FlipsAsManyBitsAsItsRateSays) {
  BitNoise noise(1e-3, 10, 42);
  std::size_t changed = 0;
  constexpr std::size_t kCharacters = 100'000;
  for (std::size_t i = 0; i < kCharacters; ++i) changed += noise.pass(0) != 0 ? 1 : 0;
  EXPECT_NEAR(static_cast<double>(changed), kCharacters * 0.00996,
              120.0);  // 1 - 0.999^10; four standard deviations
  BitNoise none(0, 10, 42), all(1, 10, 42);
  EXPECT_EQ(none.pass(0x5A), 0x5A);
  for (int i = 0; i < 100; ++i) EXPECT_NE(none.garble(0x5A), 0x5A);
  EXPECT_NE(all.pass(0x00), 0x00);
}

}  // namespace
}  // namespace fieldcast::sim
