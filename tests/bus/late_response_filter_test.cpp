#include "core/bus/wire/late_response_filter.hpp"

#include <gtest/gtest.h>

#include "core/codec/checksum.hpp"
#include "tests/bus/rtu_bus.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using Purpose = LateResponseFilter::Purpose;
using test::kHolding;

Bytes frame_of(const std::vector<std::uint16_t>& registers) {
  Bytes frame{0x01, 0x03, static_cast<std::uint8_t>(2 * registers.size())};
  for (const std::uint16_t each : registers) {
    frame.push_back(static_cast<std::uint8_t>(each >> 8));
    frame.push_back(static_cast<std::uint8_t>(each));
  }
  const std::uint16_t crc = crc16_modbus(frame);
  frame.push_back(static_cast<std::uint8_t>(crc));
  frame.push_back(static_cast<std::uint8_t>(crc >> 8));
  return frame;
}

Request read(std::uint32_t first, std::uint32_t count) {
  return ReadRequest{{{kHolding, first, count}}};
}

class LateResponseFilterTest : public testing::Test {
 protected:
  Asked ask(Request request, Instant at) {
    Asked asked{0, std::move(request), late_.next_context(0), {}};
    late_.start_anew();
    Bytes out;
    driver_.begin(setup_.protocol(0).begin(asked.request, asked.context), 200ms, EqualBytes::kEcho,
                  at, out);
    asked.sent_until = driver_.sent_until();
    return asked;
  }
  void give_up(Asked asked, Duration longest = {}) {
    Bytes out;
    const Instant now = driver_.deadline();
    (void)driver_.on_timer(now, out);
    (void)driver_.finish();
    const Range range = std::get<ReadRequest>(asked.request).ranges[0];
    late_.timed_out(std::move(asked), Block{0, {range}, {7}, {}}, longest, driver_, now);
  }
  // A response of one register, which the filter learns.
  void learn() {
    const Asked asked = ask(read(100, 1), Instant{});
    Bytes out;
    (void)driver_.on_bytes(frame_of({42}), Instant{20ms}, out);
    (void)driver_.finish();
    late_.responded(asked, false, 0ms, driver_, Instant{20ms});
  }
  Instant sendable_from(const Request& request, Purpose purpose = Purpose::kRead) const {
    return late_.sendable_from(0, request, purpose);
  }

  BusSetup setup_{test::rtu_bus(2)};
  LateResponseFilter late_{setup_};
  ExchangeDriver driver_{setup_.line(), 20ms, Echo::kAbsent};
};

TEST_F(LateResponseFilterTest, NumbersOfRequestsBeginWhereTheyAreTold) {
  EXPECT_EQ(late_.next_context(0).sequence, 1);
  late_.number_from(0xfffe);
  EXPECT_EQ(late_.next_context(0).sequence, 0xffff);
  EXPECT_EQ(late_.next_context(0).sequence, 0) << "16 bits";
}

TEST_F(LateResponseFilterTest, WhatCouldBeMistakenWaitsAndTheRestGoesOn) {
  give_up(ask(read(100, 1), Instant{}));
  EXPECT_EQ(sendable_from(read(100, 1)), kLongAgo) << "the same read again";
  EXPECT_EQ(sendable_from(read(100, 2)), kLongAgo) << "another length";
  EXPECT_GE(sendable_from(read(200, 1)), Instant{600ms}) << "three timeouts";
  EXPECT_GE(sendable_from(read(100, 1), Purpose::kCommand), Instant{600ms});
  EXPECT_EQ(late_.sendable_from(1, read(200, 1), Purpose::kRead), kLongAgo) << "another device";
  late_.expire(Instant{1s});
  EXPECT_EQ(sendable_from(read(200, 1)), kLongAgo);
  EXPECT_TRUE(late_.none_owed());
}

TEST_F(LateResponseFilterTest, AResponseWithinTheConfiguredTimeoutBringsItsValues) {
  give_up(ask(read(100, 1), Instant{}));
  const auto found = late_.in_strays(frame_of({42}), Instant{150ms});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].block.points, std::vector<PointIndex>{7});
  EXPECT_EQ(found[0].reply[0].items, (Bytes{0, 42}));
  EXPECT_GT(found[0].taken, 100ms);
  EXPECT_TRUE(late_.none_owed());
}

TEST_F(LateResponseFilterTest, AResponseBeyondItOnlyPaysTheDebt) {
  give_up(ask(read(100, 1), Instant{}));
  const auto found = late_.in_strays(frame_of({42}), Instant{400ms});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(found[0].block.points.empty());
  EXPECT_TRUE(late_.none_owed());
}

TEST_F(LateResponseFilterTest, ALateResponseIsFoundAmongTheBytesOfAnotherExchange) {
  give_up(ask(read(100, 1), Instant{}));
  const Asked other = ask(read(300, 2), Instant{230ms});
  Bytes out;
  (void)driver_.on_bytes(frame_of({42}), Instant{260ms}, out);
  EXPECT_EQ(late_.in_exchange(other, driver_, Instant{260ms}).size(), 1u);
  (void)driver_.on_bytes(frame_of({1, 2}), Instant{280ms}, out);
  EXPECT_TRUE(late_.in_exchange(other, driver_, Instant{280ms}).empty()) << "bytes count once";
  late_.responded(other, false, 0ms, driver_, Instant{280ms});
  EXPECT_TRUE(late_.none_owed());
}

TEST_F(LateResponseFilterTest, ThePendingExchangeAcceptsWhatMayBeItsOwn) {
  give_up(ask(read(100, 1), Instant{}));
  const Asked again = ask(read(100, 1), Instant{230ms});
  Bytes out;
  ASSERT_EQ(driver_.on_bytes(frame_of({42}), Instant{260ms}, out), ExchangeDriver::Outcome::kDone);
  EXPECT_TRUE(late_.in_exchange(again, driver_, Instant{260ms}).empty());
  late_.responded(again, false, 0ms, driver_, Instant{260ms});
  EXPECT_FALSE(late_.none_owed()) << "asked twice and answered once";
}

TEST_F(LateResponseFilterTest, AResponseThatComesTwicePaysOnce) {
  give_up(ask(read(100, 1), Instant{}));
  give_up(ask(read(100, 1), Instant{230ms}));
  Bytes twice = frame_of({42});
  append(twice, frame_of({42}));
  EXPECT_EQ(late_.in_strays(twice, Instant{500ms}).size(), 1u);
  EXPECT_FALSE(late_.none_owed());
}

TEST_F(LateResponseFilterTest, ABrokenResponseOfTheRightLengthAndHeadPays) {
  learn();
  Bytes out;
  const Asked broken = ask(read(100, 1), Instant{100ms});
  Bytes noisy = frame_of({42});
  noisy.back() ^= 1;
  (void)driver_.on_bytes(noisy, Instant{120ms}, out);
  give_up(broken);
  EXPECT_EQ(driver_.cause(), Cause::kChecksum);
  EXPECT_TRUE(late_.none_owed());
}

TEST_F(LateResponseFilterTest, ABrokenFrameThatMayBeAnothersDoesNotPay) {
  learn();
  struct Row {
    const char* why;
    Request request;
    Bytes received;
  };
  Bytes other_head = frame_of({42}), short_one = frame_of({42}), two = frame_of({1, 2});
  other_head[1] = 0x04;
  other_head.back() ^= 1;
  short_one.pop_back();
  two.back() ^= 1;
  for (const Row& row :
       {Row{"another head than that of the last response", read(100, 1), other_head},
        Row{"too short", read(100, 1), short_one},
        Row{"a read that no response was seen of", read(200, 2), two}}) {
    const Asked asked = ask(row.request, Instant{100ms});
    Bytes out;
    (void)driver_.on_bytes(row.received, Instant{120ms}, out);
    give_up(asked);
    EXPECT_FALSE(late_.none_owed()) << row.why;
    late_.forget_all();
  }
}

// Three timeouts of 200 ms, twice the longest response, ten timeouts; and the response itself.
TEST_F(LateResponseFilterTest, AResponseIsOwedForTwiceTheLongestWithinThreeToTenTimeouts) {
  const Duration response = setup_.line().characters(7);
  for (const auto& [longest, bound] : {std::pair{Duration{0ms}, Duration{600ms}},
                                       {250ms, 600ms},
                                       {400ms, 800ms},
                                       {1000ms, 2000ms},
                                       {5000ms, 2000ms}}) {
    const Asked asked = ask(read(100, 1), Instant{});
    const Instant until = asked.sent_until + bound + response;
    give_up(asked, longest);
    EXPECT_EQ(late_.owed_until(), until) << to_text(longest);
    late_.forget_all();
    late_.broken_off(asked, longest);
    EXPECT_EQ(late_.owed_until(), until) << to_text(longest);
    late_.forget_all();
    (void)driver_.finish();
  }
}

TEST_F(LateResponseFilterTest, TheTimeOfALateResponseIsThatOfTheDevice) {
  const Asked asked = ask(read(100, 1), Instant{});
  const Instant sent = asked.sent_until;
  give_up(asked);
  const Duration response = setup_.line().characters(7);
  const auto found = late_.in_strays(frame_of({42}), sent + 150ms + response);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].taken, 150ms);
}

// The timeout is 200 ms and the allowance 20 ms; both wait for the first character.
TEST_F(LateResponseFilterTest, ValuesCountUntilTheTimeoutAndTheAllowance) {
  const Duration response = setup_.line().characters(7);
  for (const auto& [late, counts] :
       {std::pair{Duration{220ms}, true}, {Duration{220ms} + Duration{1}, false}}) {
    const Asked asked = ask(read(100, 1), Instant{counts ? 0s : 10s});
    const Instant sent = asked.sent_until;
    give_up(asked);
    const auto found = late_.in_strays(frame_of({42}), sent + late + response);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(!found[0].block.points.empty(), counts) << to_text(late);
  }
}

TEST_F(LateResponseFilterTest, AFrameAfterAPauseOfTwoCharactersIsAnotherResponse) {
  const Duration response = setup_.line().characters(7), pause = setup_.line().characters(2);
  Instant now{};
  for (const auto& [rest, responses] : {std::pair{pause, 1u}, {pause - 1ns, 0u}}) {
    now += 10s;
    give_up(ask(read(100, 1), now));
    give_up(ask(read(100, 1), now + 230ms));
    ASSERT_EQ(late_.in_strays(frame_of({42}), now + 500ms).size(), 1u);
    EXPECT_EQ(late_.in_strays(frame_of({42}), now + 500ms + rest + response).size(), responses);
    EXPECT_EQ(late_.none_owed(), responses == 1);
    late_.forget_all();
  }
}

TEST_F(LateResponseFilterTest, ALateResponseIsFoundBehindOtherBytes) {
  give_up(ask(read(100, 1), Instant{}));
  EXPECT_TRUE(late_.in_strays(Bytes(ExchangeDriver::kMaxReceived, 0x55), Instant{300ms}).empty());
  Bytes behind{0x55, 0x55};
  append(behind, frame_of({42}));
  EXPECT_TRUE(late_.in_strays(ByteView(behind).first(5), Instant{400ms}).empty());
  EXPECT_EQ(late_.in_strays(ByteView(behind).subspan(5), Instant{405ms}).size(), 1u);
  EXPECT_TRUE(late_.none_owed());
}

TEST_F(LateResponseFilterTest, ARefusalIsALateResponseWithoutValues) {
  give_up(ask(read(100, 1), Instant{}));
  Bytes refusal{0x01, 0x83, 0x02};
  append_crc16(refusal);
  const auto found = late_.in_strays(refusal, Instant{150ms});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(found[0].block.points.empty());
  EXPECT_TRUE(late_.none_owed());
}

TEST_F(LateResponseFilterTest, WhatIsBrokenOffIsOwedToo) {
  late_.broken_off(ask(read(100, 1), Instant{}), 0ms);
  EXPECT_FALSE(late_.none_owed());
  EXPECT_TRUE(late_.owes_same({0, read(100, 1), {}, {}}));
  late_.forget_all();
  EXPECT_TRUE(late_.none_owed());
}

}  // namespace
}  // namespace fieldcast
