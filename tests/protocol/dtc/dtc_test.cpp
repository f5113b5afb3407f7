#include <gtest/gtest.h>

#include <random>

#include "core/codec/checksum.hpp"
#include "core/protocol/dtc/packet.hpp"
#include "core/protocol/families/registry.hpp"
#include "tests/protocol/dtc/dtc_text.hpp"
#include "tests/support/device.hpp"
#include "tests/support/matrix.hpp"
#include "tests/support/text_cases.hpp"

namespace fieldcast::test {
namespace {

Device plc(std::map<std::string, std::string> options = {{"threshold", "65535"}}) {
  return {"dtc", 5, std::move(options)};
}

// Three types in one request, and its response: 0102 0304 | 1,0,1,1,0,0,0,0,1 | 1.5
Request mixed(const Device& device) {
  return ReadRequest{
      {device.range("int16:100", 2), device.range("bit:65527", 9), device.range("float32:0")}};
}
const Bytes kMixed = dtc_message("05 00 01020304 0D01 3FC00000");
const Bytes kRefused = dtc_plain(dtc_message("05 80 02"));

Request many(const Device& device) { return device.read("int16:0", 40); }
Bytes many_message() {
  std::string data = "05 00";
  for (int i = 0; i < 40; ++i) data += i % 7 == 3 ? "0123" : "0000";
  return dtc_message(data);
}

TEST(DtcExchange, SeveralTypesInOneRequest) {
  const Device device = plc();
  const auto exchange = device.begin(mixed(device));
  Bytes out;
  EXPECT_EQ(exchange->start(out).characters, 3 + kMixed.size());
  EXPECT_EQ(to_hex(out),
            to_hex(dtc_plain(dtc_message("05 00 0064 01 0002 FFF7 00 0009 0000 03 0001"))));
  const Outcome outcome = drive(*exchange, dtc_plain(kMixed));
  ASSERT_TRUE(outcome.done()) << to_text(outcome);
  ASSERT_EQ(outcome.reply.size(), 3u);
  EXPECT_EQ(to_hex(outcome.reply[0].items), "01 02 03 04");
  EXPECT_EQ(to_hex(outcome.reply[1].items), "01 00 01 01 00 00 00 00 01");
  EXPECT_EQ(to_hex(outcome.reply[2].items), "3F C0 00 00");
}

// Bits 35 and 37 alone would make the response the bytes of a request with one group of 40 bits.
TEST(DtcExchange, AResponseOf33To40BitsDiffersFromItsRequest) {
  const Device device = plc();
  for (std::uint32_t count = 31; count <= 42; ++count) {
    const Request request = device.read("bit:0", count);
    const auto exchange = device.begin(request);
    Bytes out;
    const auto size = device.protocol().size(request);
    ASSERT_TRUE(size);
    const Step step = exchange->start(out);
    EXPECT_EQ(out.size(), size->request_characters) << count;
    EXPECT_NE(out.size(), step.characters) << count;
  }
  const Request request = device.read("bit:0", 40);
  const auto exchange = device.begin(request);
  Bytes out;
  (void)exchange->start(out);
  EXPECT_EQ(to_hex(out), to_hex(dtc_plain(dtc_message("05 00 0000 00 0020 0020 00 0008"))));
  const Outcome outcome = drive(*exchange, dtc_plain(dtc_message("05 00 0000000028")));
  ASSERT_TRUE(outcome.done()) << to_text(outcome);
  Bytes bits(40);
  bits[35] = bits[37] = 1;
  EXPECT_EQ(to_hex(outcome.reply.at(0).items), to_hex(bits));
}

TEST(DtcExchange, AResponseIsReadWhetherCompressedOrNot) {
  const Device device = plc();
  Reply replies[2];
  for (const bool compressed : {false, true}) {
    const auto exchange = device.begin(many(device));
    const Bytes answer = compressed ? dtc_compressed(many_message()) : dtc_plain(many_message());
    const Outcome outcome = drive(*exchange, answer);
    ASSERT_TRUE(outcome.done()) << to_text(outcome);
    replies[compressed] = outcome.reply;
  }
  EXPECT_LT(dtc_compressed(many_message()).size(), dtc_plain(many_message()).size());
  EXPECT_EQ(replies[0][0].items, replies[1][0].items);
}

TEST(DtcExchange, ARequestIsCompressedFromTheThresholdOnAndWhereItIsShorter) {
  const auto flag = [](const Request& request, const char* threshold) {
    const Device device = plc({{"threshold", threshold}});
    const Bytes packet = device.request_bytes(request);
    const auto size = device.protocol().size(request);
    EXPECT_TRUE(size && packet.size() <= size->request_characters)
        << "never longer than the plain one";
    return static_cast<int>(packet[0]);
  };
  ReadRequest list;
  for (std::uint32_t i = 0; i < 20; ++i) list.ranges.push_back({1, 10 * i, 1});
  EXPECT_EQ(flag(list, "104"), 1);  // 4 + 20 * 5 bytes
  EXPECT_EQ(flag(list, "105"), 0);
  EXPECT_EQ(flag(list, "0"), 1);
  EXPECT_EQ(flag(list, "auto"), 1);
  EXPECT_EQ(flag(ReadRequest{{{1, 0x1234, 0x56}}}, "0"), 0) << "compressed it would be longer";
}

TEST(DtcExchange, ACompressedRequestIsTheSameMessage) {
  std::mt19937 random(4);
  for (int round = 0; round < 200; ++round) {
    ReadRequest list;
    for (auto groups = 1 + random() % 200; groups > 0; --groups) {
      list.ranges.push_back(
          {static_cast<AreaIndex>(random() % 5), static_cast<std::uint32_t>(random() % 65536), 1});
    }
    const Bytes plain = plc().request_bytes(list),
                packed = plc({{"threshold", "0"}}).request_bytes(list);
    EXPECT_EQ(to_hex(dtc_unpacked(packed)), to_hex(dtc_unpacked(plain)));
    EXPECT_LE(packed.size(), plain.size());
  }
}

TEST(DtcExchange, OthersAreForeignAndThenTheResponseIsStillTaken) {
  const Device device = plc();
  for (const Bytes& other :
       {dtc_plain(dtc_message("06 00 0A0B")), dtc_plain(dtc_message("05 01")),
        dtc_compressed(many_message()), device.request_bytes(device.read("int16:9"))}) {
    const auto exchange = device.begin(device.read("int16:9"));
    const Outcome alone = drive(*exchange, other);
    EXPECT_FALSE(alone.done());
    EXPECT_TRUE(alone.cause == Cause::kForeign || alone.cause == Cause::kMalformed)
        << to_text(alone);
    Bytes both = other;
    append(both, dtc_plain(dtc_message("05 00 0A0B")));
    const auto again = device.begin(device.read("int16:9"));
    EXPECT_TRUE(drive(*again, both).done());
  }
}

// With five bytes of data, the echo of a request has the form of its response.
TEST(DtcExchange, TheEchoOfARequestIsNotItsResponse) {
  const Device device = plc();
  const Request request = device.read("bit:0", 40);
  const auto exchange = device.begin(request);
  EXPECT_EQ(drive(*exchange, device.request_bytes(request)).cause, Cause::kForeign);
}

TEST(DtcExchange, CausesAreReported) {
  const Device device = plc();
  const auto cause = [&](const Bytes& answer) {
    const auto exchange = device.begin(device.read("int16:9"));
    return drive(*exchange, answer).cause;
  };
  Bytes wrong = dtc_plain(dtc_message("05 00 0A0B"));
  EXPECT_EQ(cause({}), Cause::kNoResponse);
  EXPECT_EQ(cause(Bytes(wrong.begin(), wrong.end() - 1)), Cause::kTruncated);
  wrong.back() ^= 1;
  EXPECT_EQ(cause(wrong), Cause::kChecksum);
  EXPECT_EQ(cause(dtc_plain(dtc_message("05 00 0A0B0C0D"))),
            Cause::kMalformed);  // two values instead of one
  EXPECT_EQ(cause(dtc_plain(dtc_message("05 80"))), Cause::kMalformed);  // a refusal without a code
  EXPECT_EQ(cause(*from_hex("77 77 77")), Cause::kMalformed);
  EXPECT_EQ(cause(Bytes(2000, 0x55)), Cause::kOverlong);
  EXPECT_EQ(cause(*from_hex("01 0005 0006 3FC000")),
            Cause::kMalformed);  // an undefined code
}

TEST(DtcExchange, LengthsThatLieAreNoise) {
  const Device device = plc();
  for (const char* head : {"00 0000", "00 0003", "00 1001", "01 0002 0001", "01 0006 0005",
                           "01 0006 1001", "02 0004", "FF FFFF"}) {
    Bytes bytes = *from_hex(head);
    append(bytes, dtc_plain(dtc_message("05 00 0A0B")));
    const auto exchange = device.begin(device.read("int16:9"));
    EXPECT_TRUE(drive(*exchange, bytes).done()) << head;
  }
}

TEST(DtcExchange, TheMatrixHolds) {
  const Device device = plc();
  const auto expect = [](const MatrixCase& matrix, unsigned seed) {
    expect_matrix(matrix);
    expect_random_bytes_are_refused(matrix, seed, 3000);
  };
  expect({.begin = [&] { return device.begin(mixed(device)); }, .answers = {dtc_plain(kMixed)}}, 1);
  expect({.begin = [&] { return device.begin(many(device)); },
          .answers = {dtc_compressed(many_message())}},
         2);
  expect({.begin = [&] { return device.begin(device.write("int32:7", "01020304")); },
          .answers = {dtc_plain(dtc_message("05 01"))}},
         3);
  expect({.begin = [&] { return device.begin(device.read("int16:9")); }, .answers = {kRefused}}, 4);
}

TEST(DtcExchange, ABombIsRefusedInBoundedMemory) {
  const Device device = plc({{"max-message", "4096"}});
  const auto exchange = device.begin(device.read("int16:0", 2000));
  const Bytes bomb = dtc_compressed(Bytes(4096, 0));  // about 100 bytes
  Bytes many_bombs;
  while (many_bombs.size() < 4000) append(many_bombs, bomb);
  EXPECT_EQ(drive(*exchange, many_bombs).cause, Cause::kChecksum);
}

TEST(DtcLimits, WhatDoesNotFitTheMessageIsRefused) {
  const Device device = plc();
  const Protocol& protocol = device.protocol();
  EXPECT_TRUE(protocol.size(device.read("int16:0", 510)));
  EXPECT_FALSE(protocol.size(device.read("int16:0", 511)));
  EXPECT_EQ(protocol.areas()[1].max_read, 510);
  EXPECT_EQ(protocol.areas()[0].max_read, 8160);
  EXPECT_EQ(protocol.areas()[4].max_read, 127);
  EXPECT_EQ(protocol.traits().max_ranges, 204);
  ReadRequest list{std::vector<Range>(204, Range{1, 0, 1})};
  EXPECT_TRUE(protocol.size(list));
  list.ranges.push_back({1, 0, 1});
  EXPECT_FALSE(protocol.size(list));
  EXPECT_FALSE(protocol.size(ReadRequest{}));
  EXPECT_FALSE(protocol.size(ReadRequest{{{1, 65535, 2}}}));
  EXPECT_FALSE(protocol.size(ReadRequest{{{1, 0, 0}}}));
  EXPECT_FALSE(protocol.size(ReadRequest{{{5, 0, 1}}}));
  EXPECT_TRUE(protocol.size(WriteRequest{.range = {2, 0, 253}, .items = Bytes(1012)}));
  EXPECT_EQ(protocol.areas()[2].max_write, 253);
  EXPECT_FALSE(protocol.size(WriteRequest{.range = {2, 0, 254}, .items = Bytes(1016)}));
  EXPECT_FALSE(protocol.size(WriteRequest{.range = {2, 0, 1}, .items = Bytes(3)}));
  EXPECT_FALSE(protocol.size(WriteRequest{.range = {1, 0, 1}, .items = Bytes(2), .bit = 3}))
      << "a bit of a number is not written";
  EXPECT_FALSE(protocol.size(WriteReadRequest{{.range = {1, 0, 1}, .items = Bytes(2)}, {1, 0, 1}}));
  EXPECT_TRUE(plc({{"max-message", "4096"}}).protocol().size(device.read("int16:0", 2046)));
}

TEST(DtcOptions, FaultsSayWhatIsAllowed) {
  const auto fault = [](const char* option, const char* value) {
    const auto made = find_protocol("dtc")->make({.address = 1, .options = {{option, value}}});
    EXPECT_FALSE(made.has_value()) << option << " " << value;
    return made ? "" : made.error().option + ": " + made.error().allowed;
  };
  EXPECT_EQ(fault("threshold", "atuo"), "threshold: auto, or bytes 0..65535");
  EXPECT_EQ(fault("max-message", "4097"), "max-message: 32..4096");
  EXPECT_EQ(fault("codec-ns-per-byte", "-1"), "codec-ns-per-byte: 0..1000000");
}

TEST(DtcThreshold, AFasterLineOrASlowerDeviceCompressesLess) {
  using std::chrono::nanoseconds;
  const LineFormat slow{9600}, fast{115200}, network{10'000'000, 8, Parity::kNone, 1};
  EXPECT_EQ(dtc::auto_threshold(slow, nanoseconds{0}),
            20u);  // (8 bytes of learning + 2 of length) / 0.5
  EXPECT_EQ(dtc::auto_threshold(slow, nanoseconds{1000}), 21u);
  EXPECT_GT(dtc::auto_threshold(fast, nanoseconds{20'000}),
            dtc::auto_threshold(slow, nanoseconds{20'000}));
  EXPECT_GT(dtc::auto_threshold(fast, nanoseconds{40'000}), 100u);
  EXPECT_EQ(dtc::auto_threshold(fast, nanoseconds{48'000}), dtc::kNever);
  EXPECT_EQ(dtc::auto_threshold(network, nanoseconds{1000}), dtc::kNever);
}

TEST(DtcAddress, EachTypeHasItsOwn) {
  const Device device = plc();
  const auto name = [&](std::string_view at) { return device.address(at); };
  expect_texts(name,
               {"bit:7 -> bit:7/1", "int16:100 -> int16:100/0", "int16:100.15 -> int16:100.15/1",
                "int32:65535 -> int32:65535/0", "int32:0.31 -> int32:0.31/1",
                "float32:12 -> float32:12/32", "float64:12 -> float64:12/64"});
}

TEST(DtcAddress, FaultsSayWhatWasMeant) {
  const Device device = plc();
  const auto suggestion = [&](std::string_view at) { return device.suggestion(at); };
  expect_texts(suggestion, {"Int16:3 -> int16:3", "flaot32:3 -> float32:3", "int16 -> int16:0",
                            "int16:65536 -> int16:65535", "int16:1.16 -> int16:1.0",
                            "bit:1.0 -> bit:1", "float32:1.0 -> float32:1"});
  for (const auto* at : {"", ":", "int16:", "int16:-1", "int16:1.", "int16: 1", "holding:1"})
    (void)suggestion(at);
}

std::string explained(const Bytes& frame) {
  std::string text;
  for (const FrameField& field : find_protocol("dtc")->explain(frame)) {
    text += field.name + " " + field.value + (field.fault.empty() ? "" : " !" + field.fault) + "\n";
  }
  return text;
}

TEST(DtcExplain, SaysWhatIsInThePacket) {
  const Device device = plc();
  EXPECT_EQ(explained(device.request_bytes(mixed(device))),
            "flag 00 plain\nlength 19\naddress 5\ncommand 00 read\ngroup int16:100, count 2\ngroup "
            "bit:65527, count 9\n"
            "group float32:0, count 1\nCRC " +
                to_hex(ByteView(device.request_bytes(mixed(device))).last(2)) + "\n");
  EXPECT_NE(explained(kRefused).find("code 02 address out of range"), std::string::npos);
  const std::string packed = explained(dtc_compressed(many_message()));
  EXPECT_NE(packed.find("flag 01 compressed"), std::string::npos);
  EXPECT_NE(packed.find("data 00 00"), std::string::npos);
  EXPECT_EQ(packed.find('!'), std::string::npos) << packed;
  for (const auto* wrong :
       {"02 0004 05010000", "00 0004 0501", "00 0004 05010000", "01 0005 0006 3FC000"}) {
    EXPECT_NE(explained(*from_hex(wrong)).find('!'), std::string::npos) << wrong;
  }
}

// FFFF with a count of 2 exceeds the last variable, so these bytes are response data.
TEST(DtcExplain, DataThatLookLikeGroupsThatCannotBeAreData) {
  Bytes message{5, 0x00, 0xFF, 0xFF, 0x01, 0x00, 0x02};
  const std::uint16_t crc = crc16_modbus(message);
  message.push_back(static_cast<std::uint8_t>(crc));
  message.push_back(static_cast<std::uint8_t>(crc >> 8));
  Bytes packet{0x00, 0x00, static_cast<std::uint8_t>(message.size())};
  packet.insert(packet.end(), message.begin(), message.end());
  const std::string text = explained(packet);
  EXPECT_NE(text.find("data FF FF 01 00 02"), std::string::npos) << text;
  EXPECT_EQ(text.find('!'), std::string::npos) << text;
}

}  // namespace
}  // namespace fieldcast::test
