#include "core/bus/wire/wire_fence.hpp"

#include <gtest/gtest.h>

#include <set>

#include "core/codec/checksum.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

BusSpec bus_with(Fence fence) {
  BusSpec bus;
  bus.name = "bus";
  SerialPortSpec port;
  port.fence.kind = fence;
  bus.port = port;
  DeviceSpec device;
  device.protocol = "modbus-rtu";
  device.channels.resize(1);
  device.channels.front().range = {2, 0, 1};
  bus.devices.push_back(device);
  return bus;
}

const Bytes kForeign{0x02, 0x03, 0x00, 0x64, 0x00, 0x02, 0x85, 0xE7};
const Bytes kOwn{0x01, 0x03, 0x00, 0x64, 0x00, 0x02, 0x85, 0xD4};

struct WireFenceTest : testing::Test {
  Instant at(Duration time) const { return Instant{10s + time}; }
  // Listens for 420 ms, sends at 420 ms and receives the response at 440 ms.
  void hold() {
    fence.opened(at(0ms));
    ASSERT_TRUE(fence.may_send(at(420ms)));
    fence.sending(kOwn, at(425ms));
    fence.bytes_came(false, at(440ms));
    ASSERT_FALSE(fence.ended(true, Bytes{0x01, 0x83, 0x02, 0xC0, 0xF1}, at(440ms)));
  }
  bool stray(ByteView bytes, Instant now) {
    fence.bytes_came(false, now);
    return fence.stray(bytes, now);
  }
  WireFence fence{bus_with(Fence::kListen)};
};

TEST_F(WireFenceTest, WithoutAFenceEverythingIsAllowed) {
  WireFence none(bus_with(Fence::kNone));
  none.opened(at(0ms));
  EXPECT_TRUE(none.may_send(at(0ms)));
  EXPECT_EQ(none.sign_from(), kNever);
  EXPECT_EQ(none.sign_due(), kNever);
}

TEST_F(WireFenceTest, ALockIsWaitedWithUntilTheResponseToAnotherBridgeHasCome) {
  WireFence lock(bus_with(Fence::kLock));
  lock.opened(at(0ms));
  EXPECT_FALSE(lock.may_send(at(219ms)));
  EXPECT_EQ(lock.look_again(at(219ms)), at(220ms));
  EXPECT_TRUE(lock.may_send(at(220ms)));
}

TEST_F(WireFenceTest, AServerOfOneClientIsWaitedWithLikeALock) {
  BusSpec bus = bus_with(Fence::kNone);
  TcpPortSpec port;
  port.line = LineFormat{};
  port.fence.kind = Fence::kOneClient;
  bus.port = port;
  WireFence server(bus);
  server.opened(at(0ms));
  EXPECT_FALSE(server.may_send(at(100ms)));
  EXPECT_TRUE(server.may_send(at(1s)));
}

TEST_F(WireFenceTest, NothingIsSentBeforeTheWireWasSilent) {
  fence.opened(at(0ms));
  EXPECT_FALSE(fence.may_send(at(419ms)));
  EXPECT_FALSE(stray(Bytes{0x55}, at(419ms)));
  EXPECT_FALSE(fence.may_send(at(838ms)));
  EXPECT_TRUE(fence.may_send(at(839ms)));
}

TEST_F(WireFenceTest, AHigherRankBeginsInALaterSlot) {
  fence.set_order(2, 1);
  fence.opened(at(0ms));
  const Duration slot = fence.times().slot, first = 420ms + 2 * slot;
  EXPECT_FALSE(fence.may_send(at(first - 1ms)));
  EXPECT_TRUE(fence.may_send(at(first)));
  EXPECT_FALSE(fence.may_send(at(first + slot))) << "the slot of the next rank";
  EXPECT_EQ(fence.look_again(at(first + slot)), at(first + 8 * slot));
}

TEST_F(WireFenceTest, TheRequestOfAnotherMasterTakesTheWireAwayAndIsReportedOnce) {
  hold();
  EXPECT_TRUE(fence.may_send(at(450ms)));
  EXPECT_TRUE(stray(kForeign, at(460ms)));
  EXPECT_FALSE(fence.may_send(at(470ms)));
  EXPECT_TRUE(fence.listening());
  EXPECT_EQ(fence.text(), "another master speaks on the wire: 02 03 00 64 00 02 85 E7");
  EXPECT_FALSE(stray(kForeign, at(560ms))) << "told";
  EXPECT_EQ(fence.foreign_masters(), 1u);
  EXPECT_TRUE(fence.may_send(at(980ms)));
  EXPECT_TRUE(fence.sending(kOwn, at(985ms))) << "the wire was another master's";
}

TEST_F(WireFenceTest, ARequestInPiecesIsOne) {
  hold();
  EXPECT_FALSE(stray(ByteView(kForeign).first(3), at(460ms)));
  EXPECT_TRUE(stray(ByteView(kForeign).subspan(3), at(461ms)));
}

TEST_F(WireFenceTest, ALateEchoIsNotAnotherMaster) {
  hold();
  EXPECT_FALSE(stray(kOwn, at(445ms)));
  EXPECT_TRUE(fence.may_send(at(450ms)));
}

// Function 6 repeats the request, so one of the frames may be a duplicate response of a device.
TEST_F(WireFenceTest, WhatCouldBeAResponseIsBelievedTheThirdTime) {
  const Bytes write{0x02, 0x06, 0x00, 0x01, 0x00, 0x03, 0x98, 0x38};
  hold();
  EXPECT_FALSE(stray(write, at(450ms)));
  EXPECT_FALSE(stray(write, at(480ms)));
  EXPECT_TRUE(stray(write, at(510ms)));
}

TEST_F(WireFenceTest, WhoWasSilentForTooLongListensAgain) {
  hold();
  EXPECT_TRUE(fence.keeps(at(760ms)));
  EXPECT_TRUE(fence.may_send(at(760ms)));
  EXPECT_FALSE(fence.keeps(at(761ms)));
  EXPECT_FALSE(fence.may_send(at(761ms)));
  EXPECT_FALSE(fence.may_send(at(860ms))) << "it must hear who began just now";
}

TEST_F(WireFenceTest, NoiseDelaysTheBeginningForAWhileAndFramesForEver) {
  const Bytes answer{0x02, 0x03, 0x04, 0x00, 0x00, 0x00, 0x00, 0xC9, 0x33};
  fence.opened(at(0ms));
  Instant now = at(0ms);
  for (; now < at(10s); now += 50ms) {
    EXPECT_FALSE(stray(answer, now));
    EXPECT_FALSE(fence.may_send(now)) << "somebody is answered there";
  }
  const Instant noisy = now;
  for (; !fence.may_send(now) && now < at(30s); now += 50ms) (void)stray(Bytes{0xFF, 0x55}, now);
  EXPECT_GE(now - noisy, 9 * 420ms);
  EXPECT_LE(now - noisy, 11 * 420ms);
}

TEST_F(WireFenceTest, BrokenBytesInTheFirstExchangeAreACollision) {
  fence.opened(at(0ms));
  ASSERT_TRUE(fence.may_send(at(420ms)));
  fence.sending(kOwn, at(425ms));
  fence.bytes_came(false, at(430ms));
  EXPECT_FALSE(fence.ended(false, Bytes{0x13, 0x37}, at(460ms)));
  EXPECT_TRUE(fence.listening());
}

TEST_F(WireFenceTest, ARankBeyondTheLastIsTheLast) {
  fence.set_order(100, 1);
  fence.opened(at(0ms));
  const Duration first = 420ms + 7 * fence.times().slot;
  EXPECT_FALSE(fence.may_send(at(first - 1ms)));
  EXPECT_TRUE(fence.may_send(at(first)));
}

TEST_F(WireFenceTest, ASlotMayBeginUpToHalfASlotLate) {
  fence.opened(at(0ms));
  const Duration half = fence.times().slot / 2;
  EXPECT_TRUE(fence.may_send(at(420ms + half)));
  EXPECT_FALSE(fence.may_send(at(420ms + half + 1us)));
}

TEST_F(WireFenceTest, AnExchangeWithoutAResponseAfterOthersWithOneChangesNothing) {
  hold();
  fence.sending(kOwn, at(450ms));
  EXPECT_FALSE(fence.ended(false, Bytes{0x13, 0x37}, at(660ms)));
  EXPECT_FALSE(fence.listening());
  EXPECT_TRUE(fence.may_send(at(660ms)));
}

// Two bridges that began in the same slot would otherwise meet again and again.
TEST_F(WireFenceTest, WithoutAFirstResponseTheNextRequestWaitsForARandomSlot) {
  std::set<Duration> waits;
  for (std::uint64_t seed = 1; seed <= 64; ++seed) {
    WireFence each(bus_with(Fence::kListen));
    each.set_order(0, seed);
    each.opened(at(0ms));
    ASSERT_TRUE(each.may_send(at(420ms)));
    each.sending(kOwn, at(425ms));
    EXPECT_FALSE(each.ended(false, {}, at(625ms)));
    EXPECT_FALSE(each.listening());
    waits.insert(each.look_again(at(625ms)) - at(625ms));
  }
  ASSERT_EQ(waits.size(), WireFence::kRanks) << "each slot, with 64 seeds";
  for (unsigned slot = 0; slot < WireFence::kRanks; ++slot)
    EXPECT_TRUE(waits.contains(slot * fence.times().slot)) << slot;
}

TEST_F(WireFenceTest, AfterACollisionEachBridgeListensForATimeOfItsOwn) {
  std::set<Instant> begins;
  for (std::uint64_t seed = 1; seed <= 64; ++seed) {
    WireFence each(bus_with(Fence::kListen));
    each.set_order(3, seed);
    each.opened(at(0ms));
    const Instant start = each.look_again(at(420ms));
    ASSERT_TRUE(each.may_send(start));
    each.sending(kOwn, start + 5ms);
    each.bytes_came(false, start + 10ms);
    EXPECT_FALSE(each.ended(false, Bytes{0x13, 0x37}, start + 40ms));
    begins.insert(Instant{each.look_again(start + 40ms) - start});
  }
  ASSERT_EQ(begins.size(), WireFence::kRanks);
  EXPECT_EQ(*begins.begin(), Instant{430ms}) << "listened since the last byte";
}

TEST_F(WireFenceTest, ARequestThatWasNotSentIsListenedFor) {
  hold();
  fence.not_sent(at(500ms));
  EXPECT_TRUE(fence.listening());
  EXPECT_FALSE(fence.may_send(at(859ms)));
  EXPECT_TRUE(fence.may_send(at(860ms))) << "420 ms after the last byte";
}

TEST_F(WireFenceTest, BeforeItHoldsTheWireNothingIsKeptAndNothingEnds) {
  fence.opened(at(0ms));
  EXPECT_FALSE(fence.keeps(at(100ms)));
  EXPECT_FALSE(fence.ended(true, Bytes{0x01, 0x83, 0x02, 0xC0, 0xF1}, at(100ms)));
  fence.not_sent(at(100ms));
  EXPECT_TRUE(fence.may_send(at(420ms))) << "as if nothing had been asked";
  hold();
  EXPECT_TRUE(fence.keeps(at(440ms)));
}

TEST_F(WireFenceTest, BytesAfterALongSilenceMayBeOfAnotherMaster) {
  hold();
  fence.bytes_came(false, at(760ms));
  EXPECT_FALSE(fence.listening()) << "320 ms after the last byte";
  fence.bytes_came(false, at(1081ms));
  EXPECT_TRUE(fence.listening());
}

TEST_F(WireFenceTest, OneThatHearsOnlyItsEchoMayBeCutOffAndListens) {
  hold();
  for (const Duration sent : {600ms, 800ms, 1000ms, 1200ms}) {
    ASSERT_TRUE(fence.may_send(at(sent))) << to_text(sent);
    fence.sending(kOwn, at(sent + 5ms));
    fence.bytes_came(true, at(sent + 5ms));
    EXPECT_FALSE(fence.ended(false, {}, at(sent + 200ms)));
  }
  EXPECT_TRUE(fence.may_send(at(1280ms))) << "840 ms after the last byte of a device";
  EXPECT_FALSE(fence.may_send(at(1281ms)));
  ASSERT_TRUE(fence.listening());
  const Instant again = fence.look_again(at(1281ms));
  EXPECT_EQ(again, at(1625ms)) << "420 ms after its own last byte";
  ASSERT_TRUE(fence.may_send(again));
  fence.sending(kOwn, again + 5ms);
  EXPECT_FALSE(fence.ended(false, {}, again + 200ms));
  EXPECT_TRUE(fence.listening()) << "still nobody responds: it does not try again and again";
}

TEST_F(WireFenceTest, AResponseThatBeginsBeforeTheEndOfTheFirstRequestIsDoubtedOnce) {
  EXPECT_FALSE(fence.doubts_first(-3ms, 1ms)) << "nothing was sent";
  fence.opened(at(0ms));
  ASSERT_TRUE(fence.may_send(at(420ms)));
  fence.sending(kOwn, at(425ms));
  EXPECT_FALSE(fence.doubts_first(-2ms, 1ms)) << "within two characters";
  EXPECT_TRUE(fence.doubts_first(-3ms, 1ms));
  EXPECT_FALSE(fence.doubts_first(-3ms, 1ms)) << "the line may not keep its rate";
  (void)fence.ended(true, {}, at(440ms));
  fence.not_sent(at(500ms));
  ASSERT_TRUE(fence.may_send(fence.look_again(at(500ms))));
  fence.sending(kOwn, at(1000ms));
  EXPECT_TRUE(fence.doubts_first(-3ms, 1ms)) << "the wire was taken again";
  (void)fence.ended(true, {}, at(1010ms));
  fence.sending(kOwn, at(1050ms));
  EXPECT_FALSE(fence.doubts_first(-3ms, 1ms)) << "a device has responded";
}

TEST_F(WireFenceTest, TheRequestOfAnotherMasterWithinAnExchangeIsSeenToo) {
  hold();
  fence.sending(kOwn, at(450ms));
  Bytes received{0x01, 0x83};
  EXPECT_FALSE(fence.came_between(received, at(455ms)));
  append(received, kForeign);
  EXPECT_TRUE(fence.came_between(received, at(460ms)));
  EXPECT_TRUE(fence.listening());
  EXPECT_FALSE(fence.came_between(received, at(461ms))) << "it listens";

  EXPECT_TRUE(fence.may_send(fence.look_again(at(470ms))));
  EXPECT_TRUE(fence.sending(kOwn, at(900ms)));
  EXPECT_FALSE(fence.sending(kOwn, at(910ms))) << "taken back once";
  EXPECT_TRUE(fence.ended(false, kForeign, at(950ms))) << "instead of a response";
  EXPECT_TRUE(fence.listening());
  EXPECT_EQ(fence.foreign_masters(), 2u);
}

TEST_F(WireFenceTest, ADeviceThatRepeatsItsResponseIsNotAnotherMaster) {
  const Bytes write{0x02, 0x06, 0x00, 0x01, 0x00, 0x03, 0x98, 0x38};  // request or response
  hold();
  fence.sending(kOwn, at(450ms));
  (void)fence.ended(true, write, at(460ms));
  for (int repeated = 1; repeated <= 5; ++repeated)
    EXPECT_FALSE(stray(write, at(460ms + repeated * 30ms)));
  EXPECT_FALSE(fence.listening());
}

TEST_F(WireFenceTest, WhatCouldBeAResponseCountsForASecond) {
  const Bytes write{0x02, 0x06, 0x00, 0x01, 0x00, 0x03, 0x98, 0x38};
  hold();
  for (const Duration time : {600ms, 800ms, 1601ms, 1700ms}) {
    for (Duration before = time - 250ms; before < time; before += 100ms)
      fence.bytes_came(false, at(before));  // of devices, so that the wire is kept
    EXPECT_FALSE(stray(write, at(time))) << to_text(time);
    fence.bytes_came(false, at(time + 200ms));
    fence.bytes_came(false, at(time + 400ms));
  }
  EXPECT_TRUE(stray(write, at(2200ms))) << "the third one within a second";
}

TEST_F(WireFenceTest, TheTextShowsTheFirstSixteenBytesOfALongRequest) {
  Bytes write{0x02, 0x10, 0x00, 0x00, 0x00, 0x05, 0x0A, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
  append_crc16(write);
  hold();
  ASSERT_TRUE(stray(write, at(460ms)));
  EXPECT_EQ(fence.text(),
            "another master speaks on the wire: 02 10 00 00 00 05 0A 01 02 03 04 05 06 07 08 09");
}

TEST_F(WireFenceTest, ARequestBehindMuchNoiseIsFound) {
  hold();
  for (int part = 0; part < 20; ++part)
    EXPECT_FALSE(stray(Bytes(60, 0x55), at(450ms + part * 5ms)));
  EXPECT_TRUE(stray(kForeign, at(555ms)));
}

TEST_F(WireFenceTest, ARestInARequestMakesTwoBurstsOfIt) {
  hold();
  EXPECT_FALSE(stray(ByteView(kForeign).first(3), at(460ms)));
  EXPECT_FALSE(stray(ByteView(kForeign).subspan(3), at(481ms))) << "more than 20 ms";
  EXPECT_FALSE(stray(ByteView(kForeign).first(3), at(510ms)));
  EXPECT_TRUE(stray(ByteView(kForeign).subspan(3), at(530ms)));
}

TEST_F(WireFenceTest, OneThatSendsMakesItselfHeard) {
  hold();
  EXPECT_EQ(fence.sign_from(), at(515ms));
  EXPECT_EQ(fence.sign_due(), at(540ms));
  fence.no_sign(at(530ms));  // there was nothing to read
  EXPECT_EQ(fence.sign_from(), at(555ms));
  EXPECT_EQ(fence.sign_due(), at(555ms));
}

}  // namespace
}  // namespace fieldcast
