#include <gtest/gtest.h>

#include "core/codec/checksum.hpp"
#include "core/protocol/modbus/areas.hpp"
#include "core/protocol/modbus/framing.hpp"
#include "core/protocol/modbus/modbus.hpp"
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

// Published frames of an Inova temperature simulator (see the vectors).
const Bytes kModel = hex("012B0E0481000001 01 09 494E562D436170706F BEB7");

TEST(RtuExchange, ATextIsPaddedAndCutToItsItems) {
  const auto items = [](std::uint32_t first, std::uint32_t count) {
    auto exchange = rtu(1, read(Table::kIdentity, first, count));
    const Outcome outcome = drive(exchange, kModel);
    EXPECT_EQ(outcome.sent.front(), hex("012B0E04 01 B2E7"));
    if (!outcome.done()) return to_text(outcome);
    const Bytes& text = outcome.reply.at(0).items;
    return std::string(text.begin(), text.end());
  };
  EXPECT_EQ(items(244, 9), "INV-Cappo");
  EXPECT_EQ(items(244, 3), "INV");
  EXPECT_EQ(items(244 + 4, 5), "Cappo");
  EXPECT_EQ(items(244, 12), std::string("INV-Cappo\0\0\0", 12));
}

TEST(RtuExchange, ATextNamesItsMissingCharactersAsFarAsTheyAreKnown) {
  auto exchange = rtu(1, read(Table::kIdentity, 244, 16));
  Bytes out;
  (void)exchange.start(out);
  for (std::size_t size = 3; size < kModel.size(); ++size) {
    const Step step = exchange.on_bytes(ByteView(kModel).first(size), out);
    EXPECT_EQ(step.kind, Step::Kind::kNeedMore);
    EXPECT_EQ(step.wait, Wait::kRestOfFrame);
    EXPECT_GE(step.characters, 1u);
    EXPECT_LE(step.characters, kModel.size() - size) << size;
  }
}

TEST(RtuExchange, AnObjectThatWasNotRequestedIsNoValue) {
  for (const std::string_view other :
       {"012B0E0481000001 00 09 494E562D436170706F", "012B0E0181000001 01 09 494E562D436170706F",
        "012B0E0481000002 01 01 41 02 01 42", "012B0E048100000101 08 494E562D436170706F",
        "012B0D0481000001 01 09 494E562D436170706F", "012B0E0481000000"}) {
    auto exchange = rtu(1, read(Table::kIdentity, 244, 16));
    const Outcome outcome = drive(exchange, with_crc(other));
    EXPECT_FALSE(outcome.done()) << other;
  }
}

// Modbus Application Protocol V1.1b3, 6.18.
const Bytes kQueue = with_crc("11 18 0006 0002 01B8 1284");

TEST(RtuExchange, RegistersBehindTheEndOfAQueueAreAbsent) {
  const auto read_queue = [](std::uint32_t position, std::uint32_t count) {
    auto exchange = rtu(17, read(Table::kFifo, 1246 * 32 + position, count));
    const Outcome outcome = drive(exchange, kQueue);
    EXPECT_EQ(outcome.sent.front(), with_crc("11 18 04DE"));
    return outcome.done() ? outcome.reply.at(0) : RangeReply{Cause::kMalformed};
  };
  const auto absent = [](std::uint32_t position, std::uint32_t count) {
    return std::vector<Range>{{static_cast<AreaIndex>(Table::kFifo), 1246 * 32 + position, count}};
  };
  EXPECT_EQ(read_queue(0, 3).items, hex("0002 01B8 1284"));
  EXPECT_TRUE(read_queue(0, 3).absent.empty());
  EXPECT_EQ(read_queue(2, 1).items, hex("1284"));
  EXPECT_EQ(read_queue(0, 32).absent, absent(3, 29));
  EXPECT_EQ(read_queue(2, 2).items, hex("1284 0000"));
  EXPECT_EQ(read_queue(2, 2).absent, absent(3, 1));
  EXPECT_EQ(read_queue(31, 1).absent, absent(31, 1));
}

TEST(RtuExchange, AQueueOfOtherCountsIsNoValue) {
  std::string long_queue = "1118 0042 0020", longest = "1118 0040 001F";
  for (int i = 0; i < 32; ++i) long_queue += "0001";
  for (int i = 0; i < 31; ++i) longest += "0001";
  const auto is_read = [](std::string_view response) {
    auto exchange = rtu(17, read(Table::kFifo, 1246 * 32, 1));
    return drive(exchange, with_crc(response)).done();
  };
  EXPECT_TRUE(is_read("1118 0002 0000"));
  EXPECT_TRUE(is_read(longest));
  EXPECT_FALSE(is_read(long_queue)) << "32 registers";
  EXPECT_FALSE(is_read("1118 0006 0001 01B8 1284")) << "a count of one for two";
  EXPECT_FALSE(is_read("1118 0006 0003 01B8 1284"));
  EXPECT_FALSE(is_read("1118 0003 0001 01"));
  EXPECT_FALSE(is_read("1118 0000"));
}

// No response of function 24 names its queue.
TEST(RtuExchange, AResponseOfOneQueueCouldBeThatOfAnother) {
  const auto protocol = *rtu_entry().make({.address = 17});
  const auto mistakable = [&](const Request& earlier, const Request& later) {
    return protocol->mistakable(earlier, {1}, later, {2});
  };
  const Request first = read(Table::kFifo, 32, 1), second = read(Table::kFifo, 64, 8);
  EXPECT_TRUE(mistakable(first, second));
  EXPECT_FALSE(mistakable(first, read(Table::kHolding, 0, 33)));
}

TEST(RtuExchange, RecordsOfOtherLengthsAreNoValue) {
  const ReadRequest two{{{static_cast<AreaIndex>(Table::kFile), 40001, 2},
                         {static_cast<AreaIndex>(Table::kFile), 30009, 2}}};
  const auto is_read = [&](std::string_view response) {
    auto exchange = rtu(17, two);
    return drive(exchange, with_crc(response)).done();
  };
  EXPECT_TRUE(is_read("11140C 05060DFE0020 050633CD0040"));
  EXPECT_FALSE(is_read("11140C 03060DFE 070633CD00400000")) << "registers of the other group";
  EXPECT_FALSE(is_read("11140C 05070DFE0020 050633CD0040")) << "another reference type";
  EXPECT_FALSE(is_read("111406 05060DFE0020")) << "one group only";
  EXPECT_FALSE(is_read("11140B 05060DFE0020 050633CD0040")) << "a wrong byte count";
}

TEST(RtuExchange, RecordsStayWithinTheirLimits) {
  const auto area = static_cast<AreaIndex>(Table::kFile);
  const auto fits = [](const ReadRequest& request) { return pdu_sizes(request, {}).has_value(); };
  EXPECT_TRUE(fits({{{area, 40000, 121}}}));
  EXPECT_FALSE(fits({{{area, 40000, 122}}}));
  EXPECT_TRUE(fits({{{area, 49999, 1}}}));
  EXPECT_FALSE(fits({{{area, 49999, 2}}})) << "reaches into the next file";
  EXPECT_FALSE(fits({{{area, kFiles * kRecords - 1, 2}}}));
  EXPECT_TRUE(fits({std::vector<Range>(35, {area, 40000, 1})}));
  EXPECT_FALSE(fits({std::vector<Range>(36, {area, 40000, 1})})) << "245 bytes of groups";
  EXPECT_TRUE(fits({{{area, 40000, 60}, {area, 50000, 60}}}));
  EXPECT_FALSE(fits({{{area, 40000, 61}, {area, 50000, 60}}})) << "245 bytes of records";
  EXPECT_FALSE(fits({{{area, 40000, 1}, {static_cast<AreaIndex>(Table::kHolding), 0, 1}}}));
  EXPECT_FALSE(fits({{{static_cast<AreaIndex>(Table::kHolding), 0, 1},
                      {static_cast<AreaIndex>(Table::kHolding), 9, 1}}}));
  const WriteRequest bit{.range = {area, 40000, 1}, .items = {0, 1}, .bit = 0};
  EXPECT_FALSE(pdu_sizes(bit, {.mask_write = true})) << "function 22 is for holding registers";
}

// The response has 11 bytes. In doubt, the wait is for eight more at most; each byte restarts it.
TEST(RtuExchange, AMaskIsForOneHoldingRegister) {
  const auto masked = [](Table table, std::uint32_t count) {
    const auto area = static_cast<AreaIndex>(table);
    const bool bits = table == Table::kCoil;
    return WriteRequest{.range = {area, 10000, count},
                        .items = Bytes(image_bytes(bits ? 1 : 16, count)),
                        .mask = std::uint16_t{0x00F0}};
  };
  EXPECT_TRUE(pdu_sizes(masked(Table::kHolding, 1), {}));
  EXPECT_FALSE(pdu_sizes(masked(Table::kHolding, 2), {}));
  EXPECT_FALSE(pdu_sizes(masked(Table::kCoil, 1), {}));
  EXPECT_FALSE(pdu_sizes(masked(Table::kFile, 1), {}));
  const Range read{static_cast<AreaIndex>(Table::kHolding), 0, 1};
  EXPECT_FALSE(pdu_sizes(WriteReadRequest{masked(Table::kHolding, 1), read}, {}));
  WriteRequest most{.range = {read.area, 0, 121}, .items = Bytes(242)};
  EXPECT_TRUE(pdu_sizes(WriteReadRequest{most, read}, {}));
  most = {.range = {read.area, 0, 122}, .items = Bytes(244)};
  EXPECT_FALSE(pdu_sizes(WriteReadRequest{most, read}, {})) << "function 23 writes 121 registers";
}

TEST(RtuExchange, AnIncompleteFrameIsWaitedForAsLongAsItsFieldsSay) {
  struct Part {
    const char* what;
    std::string_view received;
    std::uint32_t missing;
  };
  for (const Part& row : {Part{"the unit", "11", 10},
                          {"the function", "11 03", 9},
                          {"the response", "11 03 06", 8},
                          {"all but a byte", "11 03 06 AE 41 56 52 43 40 49", 1},
                          {"an exception", "11 83", 3},
                          {"its code", "11 83 02", 2},
                          {"another length", "11 03 20 AE", 8},
                          {"a shorter one", "11 03 02 AE", 3},
                          {"of another unit", "12 03 06 AE", 7},
                          {"a long one of it", "12 03 20 AE", 8},
                          {"an exception of it", "12 83", 3},
                          {"behind noise", "F9 11 03 06", 8},
                          {"an exception there", "F9 11 83", 3}}) {
    ModbusExchange exchange = classic();
    Bytes out;
    (void)exchange.start(out);
    const Step step = exchange.on_bytes(hex(row.received), out);
    EXPECT_EQ(step.wait, Wait::kRestOfFrame) << row.what;
    EXPECT_EQ(step.characters, row.missing) << row.what;
  }
}

// ':', 22 digits and CR LF. The wait counts characters, two for each byte.
TEST(AsciiExchange, AnIncompleteFrameIsWaitedForAsLongAsTheResponseIs) {
  struct Part {
    std::string_view received;
    std::uint32_t missing;
  };
  for (const Part& row : {Part{":", 22},
                          {":1", 21},
                          {":1103", 18},
                          {":110306AE415652434", 5},
                          {":110306AE41565243402D\r", 1},
                          {":1183", 6},
                          {":118302", 4},
                          {"xx:1103", 18},
                          {":1103:", 22},
                          {":110306AE41565243402D0000", 1}}) {
    ModbusExchange exchange{ascii_framing(), Header{17, 0}, read(Table::kHolding, 107, 3), {}};
    Bytes out;
    (void)exchange.start(out);
    const Bytes received(row.received.begin(), row.received.end());
    const Step step = exchange.on_bytes(received, out);
    EXPECT_EQ(step.wait, Wait::kRestOfFrame) << row.received;
    EXPECT_EQ(step.characters, row.missing) << row.received;
  }
}

// 1968 is the limit of the standard: V1.1b3, 6.11. The second frame has 256 bytes, as many as a
// frame may have.
TEST(SeenRtuRequest, WritesAtMost1968Coils) {
  for (const auto& [head, bytes, seen] :
       {std::tuple{"11 0F 00 00 07 B0 F6", 246u, true}, {"11 0F 00 00 07 B1 F7", 247u, false}}) {
    Bytes frame = hex(head);
    frame.resize(frame.size() + bytes);
    append_crc16(frame);
    EXPECT_EQ(static_cast<bool>(seen_rtu_request(frame)), seen) << head;
  }
}

}  // namespace
}  // namespace fieldcast::modbus
