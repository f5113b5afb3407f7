#include <gtest/gtest.h>

#include "core/codec/checksum.hpp"
#include "core/protocol/modbus/areas.hpp"
#include "core/protocol/modbus/framing.hpp"
#include "tests/support/drive.hpp"

namespace fieldcast::modbus {
namespace {

using test::drive;
using test::Outcome;

Bytes hex(std::string_view text) { return *from_hex(text); }
Bytes with_crc(std::string_view text) {
  Bytes frame = hex(text);
  const std::uint16_t crc = crc16_modbus(frame);
  frame.push_back(static_cast<std::uint8_t>(crc));
  frame.push_back(static_cast<std::uint8_t>(crc >> 8));
  return frame;
}
Bytes joined(std::initializer_list<Bytes> parts) {
  Bytes all;
  for (const Bytes& part : parts) append(all, part);
  return all;
}

Request read(Table table, std::uint32_t first, std::uint32_t count) {
  return ReadRequest{{{static_cast<AreaIndex>(table), first, count}}};
}
ModbusExchange rtu(std::uint8_t unit, const Request& request, Options options = {}) {
  return {rtu_framing(), Header{unit, 0}, request, options};
}
// Unit 17 reads holding 107..109: the standard example of protocol guides.
ModbusExchange classic() { return rtu(17, read(Table::kHolding, 107, 3)); }
const Bytes kAnswer = hex("1103 06 AE41 5652 4340 49AD");
const Bytes kItems = hex("AE41 5652 4340");

TEST(RtuExchange, ReadsTheClassicExample) {
  auto exchange = classic();
  const Outcome outcome = drive(exchange, kAnswer);
  EXPECT_EQ(outcome.sent.front(), hex("1103 006B 0003 7687"));
  ASSERT_TRUE(outcome.done()) << to_text(outcome.cause);
  EXPECT_EQ(outcome.reply.at(0).items, kItems);
  EXPECT_FALSE(outcome.waited);
}

TEST(RtuExchange, NamesTheMissingCharacters) {
  auto exchange = classic();
  Bytes out;
  EXPECT_EQ(exchange.start(out).characters, kAnswer.size());
  for (std::size_t size = 1; size < kAnswer.size(); ++size) {
    const Step step = exchange.on_bytes(ByteView(kAnswer).first(size), out);
    EXPECT_EQ(step.kind, Step::Kind::kNeedMore);
    EXPECT_EQ(step.wait, Wait::kRestOfFrame);
    EXPECT_EQ(step.characters, kAnswer.size() - size) << size;
  }
}

TEST(RtuExchange, ForeignResponseIsSkippedAndTheWaitGoesOn) {
  const Bytes foreign = with_crc("12 03 06 0001 0002 0003");
  auto exchange = classic();
  Bytes out;
  (void)exchange.start(out);
  const Step step = exchange.on_bytes(foreign, out);
  EXPECT_EQ(step.kind, Step::Kind::kNeedMore);
  EXPECT_EQ(step.wait, Wait::kResponse);
  const Outcome outcome = drive(exchange, joined({foreign, kAnswer}));
  ASSERT_TRUE(outcome.done());
  EXPECT_EQ(outcome.reply.at(0).items, kItems);
}

TEST(RtuExchange, LateResponseOfAnotherLengthIsSkipped) {
  auto exchange = classic();
  EXPECT_TRUE(drive(exchange, joined({with_crc("11 03 02 0007"), kAnswer})).done());
  auto alone = classic();
  EXPECT_EQ(drive(alone, with_crc("11 03 02 0007")).cause, Cause::kMalformed);
}

TEST(RtuExchange, AnotherFunctionIsSkipped) {
  auto exchange = classic();
  EXPECT_EQ(drive(exchange, with_crc("11 04 06 0001 0002 0003")).cause, Cause::kForeign);
  auto refused = classic();
  EXPECT_EQ(drive(refused, with_crc("11 84 02")).cause, Cause::kForeign);
}

TEST(RtuExchange, SpuriousZeroAtTheTurnAroundIsSkipped) {
  auto exchange = classic();
  const Outcome outcome = drive(exchange, joined({hex("00"), kAnswer}));
  ASSERT_TRUE(outcome.done());
  EXPECT_FALSE(outcome.waited);
}

TEST(RtuExchange, GarbageBeforeTheResponseIsSkipped) {
  auto exchange = classic();
  EXPECT_TRUE(drive(exchange, joined({hex("AA 55 13"), kAnswer})).done());
}

TEST(RtuExchange, BrokenResponseFollowedByAGoodOneIsRead) {
  Bytes broken = kAnswer;
  broken[4] ^= 0x10;
  auto exchange = classic();
  EXPECT_TRUE(drive(exchange, joined({broken, kAnswer})).done());
}

TEST(RtuExchange, AResponseInsideAnotherDevicesDataIsNotTaken) {
  Bytes foreign = hex("12 03 0E 0001");
  append(foreign, kAnswer);
  append(foreign, hex("00"));
  const std::uint16_t crc = crc16_modbus(foreign);
  append(foreign, Bytes{static_cast<std::uint8_t>(crc), static_cast<std::uint8_t>(crc >> 8)});
  auto exchange = classic();
  EXPECT_EQ(test::drive_bytewise(exchange, {&foreign, 1}).cause, Cause::kForeign);
}

TEST(RtuExchange, NoiseThatLooksLikeAFramesBeginningDelaysTheResponseBySilenceOnly) {
  const Bytes stream = joined({hex("05 03 40"), kAnswer});
  auto exchange = classic();
  const Outcome outcome = drive(exchange, stream);
  ASSERT_TRUE(outcome.done()) << to_text(outcome.cause);
  EXPECT_TRUE(outcome.waited);
  EXPECT_EQ(outcome.reply.at(0).items, kItems);
}

TEST(RtuExchange, EveryFailureHasItsCause) {
  const auto cause_of = [](const Bytes& answer) {
    auto exchange = classic();
    return drive(exchange, answer).cause;
  };
  Bytes broken = kAnswer;
  broken.back() ^= 1;
  EXPECT_EQ(cause_of({}), Cause::kNoResponse);
  EXPECT_EQ(cause_of(hex("00 FF")), Cause::kNoResponse);
  EXPECT_EQ(cause_of(hex("11 03 06 AE 41")), Cause::kTruncated);
  EXPECT_EQ(cause_of(hex("11")), Cause::kTruncated);
  EXPECT_EQ(cause_of(broken), Cause::kChecksum);
  EXPECT_EQ(cause_of(with_crc("11 03 05 AE41 5652 4340")), Cause::kMalformed);
  EXPECT_EQ(cause_of(with_crc("12 03 06 AE41 5652 4340")), Cause::kForeign);
  EXPECT_EQ(cause_of(hex("55 AA 55 AA")), Cause::kMalformed);
  EXPECT_EQ(cause_of(Bytes(kMaxReceived + 1, 0x55)), Cause::kOverlong);
}

TEST(RtuExchange, ExceptionsCarryTheirCode) {
  for (const std::uint8_t code : std::initializer_list<std::uint8_t>{1, 2, 3, 7, 99}) {
    auto exchange = classic();
    const Outcome outcome = drive(exchange, with_crc("1183" + to_hex({&code, 1})));
    EXPECT_EQ(outcome.cause, Cause::kDeviceError);
    EXPECT_EQ(outcome.code, code);
  }
  for (const std::uint8_t code : std::initializer_list<std::uint8_t>{4, 5, 6, 8, 10, 11}) {
    auto exchange = classic();
    const Outcome outcome = drive(exchange, with_crc("1183" + to_hex({&code, 1})));
    EXPECT_EQ(outcome.cause, Cause::kDeviceBusy);
    EXPECT_EQ(outcome.code, code);
  }
}

TEST(RtuExchange, AWriteIsConfirmedByItsOwnEchoAlone) {
  const Request write =
      WriteRequest{.range = {static_cast<AreaIndex>(Table::kHolding), 1, 1}, .items = hex("0003")};
  auto right = rtu(17, write);
  const Outcome outcome = drive(right, with_crc("11 06 0001 0003"));
  EXPECT_EQ(outcome.sent.front(), with_crc("11 06 0001 0003"));
  ASSERT_TRUE(outcome.done());
  EXPECT_TRUE(outcome.reply.at(0).items.empty());
  auto other_value = rtu(17, write);
  EXPECT_EQ(drive(other_value, with_crc("11 06 0001 0004")).cause, Cause::kMalformed);
  auto other_address = rtu(17, write);
  EXPECT_EQ(drive(other_address, with_crc("11 06 0002 0003")).cause, Cause::kMalformed);
}

}  // namespace
}  // namespace fieldcast::modbus
