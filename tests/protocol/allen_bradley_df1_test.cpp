#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/codec/checksum.hpp"
#include "core/protocol/families/registry.hpp"
#include "tests/support/device.hpp"
#include "tests/support/matrix.hpp"
#include "tests/support/text_cases.hpp"
#include "tests/support/vectors.hpp"

namespace fieldcast::test {
namespace {

Bytes hex(std::string_view text) { return *from_hex(text); }
Device plc(std::map<std::string, std::string> options = {}, std::uint16_t node = 1) {
  return {"allen-bradley-df1", node, options};
}
Device half_duplex(std::uint16_t node = 17) { return plc({{"duplex", "half"}}, node); }
std::vector<FrameField> explain(const Bytes& frame) {
  return find_protocol("allen-bradley-df1")->explain(frame);
}
std::string faults(const std::vector<FrameField>& fields) {
  std::string text;
  for (const FrameField& field : fields) text += field.fault.empty() ? "" : field.fault + ";";
  return text;
}
std::string value(const Bytes& frame, std::string_view name) {
  for (const FrameField& field : explain(frame))
    if (field.name == name) return field.value;
  return "none";
}

// A slave's packet, built independently of the codec.
Bytes packet(std::string_view data, bool bcc = false) {
  const Bytes plain = hex(data);
  Bytes frame = hex("10 02"), counted = plain;
  for (const std::uint8_t byte : plain) frame.insert(frame.end(), byte == 0x10 ? 2 : 1, byte);
  append(frame, hex("10 03"));
  counted.push_back(0x03);
  const std::uint16_t crc = crc16_arc(counted);
  frame.push_back(bcc ? lrc8(plain) : static_cast<std::uint8_t>(crc));
  if (!bcc) frame.push_back(static_cast<std::uint8_t>(crc >> 8));
  return frame;
}
Bytes acknowledged(std::string_view data) {
  Bytes response = hex("10 06");
  append(response, packet(data));
  return response;
}
const std::string kAck = "10 06", kNak = "10 15";

TEST(Df1Vectors, PublishedFramesHaveNoFault) {
  int seen = 0;
  for (const GoldenVector& vector : load_vectors("df1")) {
    SCOPED_TRACE(vector.name);
    for (const Bytes& frame : {vector.request, vector.response}) {
      if (frame.empty()) continue;
      ++seen;
      EXPECT_EQ(faults(explain(frame)), "");
      for (std::size_t bit = 0; bit < frame.size() * 8; ++bit) {
        Bytes flipped = frame;
        flipped[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
        (void)explain(flipped);
      }
    }
  }
  EXPECT_GE(seen, 15);
}

TEST(Df1Vectors, OurRequestsAreTheirs) {
  int seen = 0;
  for (const GoldenVector& vector : load_vectors("df1")) {
    if (vector.kind != "ok") continue;
    SCOPED_TRACE(vector.name);
    ++seen;
    const Device device = plc();
    const std::uint16_t tns =
        static_cast<std::uint16_t>(vector.request[6] | vector.request[7] << 8);
    const std::string at = vector.texts.at("at");
    const Request request = vector.has("on") ? device.write_bit(at, vector.texts.at("on") == "1")
                                             : device.read(at, vector.request[9] / 2u);
    EXPECT_EQ(to_hex(device.request_bytes(request, tns)), to_hex(vector.request));
  }
  EXPECT_EQ(seen, 4);
}

TEST(Df1Vectors, RepliesOfAPlcAreRead) {
  int seen = 0;
  for (const GoldenVector& vector : load_vectors("df1")) {
    if (vector.kind != "reply") continue;
    SCOPED_TRACE(vector.name);
    ++seen;
    const Device device = plc();
    const std::uint16_t tns =
        static_cast<std::uint16_t>(vector.response[6] | vector.response[7] << 8);
    Bytes response = hex(kAck);
    append(response, vector.response);
    const Request read = device.read("N7:0", 40);
    const auto exchange = device.begin(read, tns);
    const Outcome outcome = drive(*exchange, response);
    ASSERT_TRUE(outcome.done()) << to_text(outcome);
    EXPECT_EQ(to_hex(outcome.confirmation), kAck);
    const Bytes& items = outcome.reply[0].items;
    ASSERT_EQ(items.size(), 80u);
    EXPECT_EQ(read_u16(items, 0), vector.response[8] | vector.response[9] << 8);
    EXPECT_EQ(items[13], vector.response[20]);
    EXPECT_EQ(items[12], 0x10) << "doubled on the wire";
    expect_matrix({.begin = [&] { return device.begin(read, tns); }, .answers = {response}});
  }
  EXPECT_EQ(seen, 2);
}

TEST(Df1, TheMasterOfALineChecksStationAndStx) {
  const Device device = half_duplex();
  const Bytes request = device.request_bytes(device.read("N7:0"), 0x1234);
  EXPECT_EQ(to_hex(ByteView(request).first(5)), "10 01 11 10 02");
  const Bytes counted = hex("11 02 11 00 0F 00 34 12 A2 02 07 89 00 00 03");
  EXPECT_EQ(to_hex(ByteView(request).last(2)),
            to_hex(Bytes{static_cast<std::uint8_t>(crc16_arc(counted)),
                         static_cast<std::uint8_t>(crc16_arc(counted) >> 8)}));
  EXPECT_EQ(to_hex(ByteView(half_duplex(16).request_bytes(device.read("N7:0"))).first(8)),
            "10 01 10 10 10 02 10 10");
}

TEST(Df1, RequestsNameFileElementAndPart) {
  const Device device = plc({{"check", "bcc"}});
  const auto fields = [&](const Request& request) {
    const Bytes bytes = device.request_bytes(request);
    return to_hex(ByteView(bytes).subspan(8, bytes.size() - 11));
  };
  EXPECT_EQ(fields(device.read("N7:5", 3)), "A2 06 07 89 05 00");
  EXPECT_EQ(fields(device.read("N255:300")), "A2 02 FF FF 00 89 FF 2C 01 00");
  EXPECT_EQ(fields(device.read("N7:16")), "A2 02 07 89 10 10 00") << "a byte 10 is doubled";
  EXPECT_EQ(fields(device.read("F8:3", 2)), "A2 08 08 8A 03 00");
  EXPECT_EQ(fields(device.read("L9:1")), "A2 04 09 91 01 00");
  EXPECT_EQ(fields(device.read("B3/21")), "A2 02 03 85 01 00");
  EXPECT_EQ(fields(device.read("T4:2.ACC")), "A2 06 04 86 02 00") << "the whole timer";
  EXPECT_EQ(fields(device.read("C5:0.ACC", 4)), "A2 0C 05 87 00 00") << "two counters";
  EXPECT_EQ(fields(device.read("S:1")), "A2 02 02 84 01 00");
  EXPECT_EQ(fields(device.read("I:3.2")), "A2 02 01 8C 03 02");
  EXPECT_EQ(fields(device.read("O:2.0", 2)), "A2 04 00 8B 02 00");
  EXPECT_EQ(fields(device.write("N7:0", "12 34 00 02")), "AA 04 07 89 00 00 34 12 02 00");
  EXPECT_EQ(fields(device.write("F8:0", "3F C0 00 00")), "AA 04 08 8A 00 00 00 00 C0 3F");
  EXPECT_EQ(fields(device.write("T4:1.PRE", "01 F4")), "AA 02 04 86 01 01 F4 01");
  EXPECT_EQ(fields(device.write_bit("C5:1/CU", false)), "AB 02 05 87 01 00 00 80 00 00");
}

TEST(Df1, APartOfATimerIsCutOutOfItsElement) {
  const Device device = plc();
  const auto exchange = device.begin(device.read("T4:0.PRE", 2), 5);
  const Outcome outcome = drive(*exchange, acknowledged("00 01 4F 00 05 00 00 20 F4 01 22 01"));
  ASSERT_TRUE(outcome.done()) << to_text(outcome);
  EXPECT_EQ(to_hex(outcome.reply[0].items), "01 F4 01 22");
}

// A float is stored with its low word first (nodepccc 0.1.17 reads it with readFloatLE).
TEST(Df1, AFloatHasItsLowByteFirst) {
  const Device device = plc();
  const auto exchange = device.begin(device.read("F8:0"), 5);
  const Outcome outcome = drive(*exchange, acknowledged("00 01 4F 00 05 00 00 E6 F1 47"));
  ASSERT_TRUE(outcome.done()) << to_text(outcome);
  EXPECT_EQ(to_hex(outcome.reply[0].items), "47 F1 E6 00");
}

TEST(Df1, ARefusalIsAcknowledgedAndHasItsCode) {
  const Device device = plc();
  const auto run = [&](std::string_view data) {
    const auto exchange = device.begin(device.read("N7:0"), 5);
    return drive(*exchange, acknowledged(data));
  };
  EXPECT_EQ(to_text(run("00 01 4F 10 05 00")), "failed: refused by the device code 16");
  EXPECT_EQ(to_text(run("00 01 4F F0 05 00 0B")),
            "failed: refused by the device code " + std::to_string(0xF00B));
  EXPECT_EQ(run("00 01 4F F0 05 00 1F").cause, Cause::kDeviceBusy);
  EXPECT_EQ(to_hex(run("00 01 4F 70 05 00").confirmation), kAck);
  EXPECT_EQ(device_code_words(device.protocol().traits().codes, 0xF00B), "F00B access denied");
}

TEST(Df1, APacketOfAnotherRequestIsAcknowledgedAndTheWaitContinues) {
  const Device device = plc();
  const auto run = [&](const Bytes& foreign) {
    const auto exchange = device.begin(device.read("N7:0"), 5);
    const std::vector<Bytes> answers{foreign, packet("00 01 4F 00 05 00 2A 00")};
    const Outcome outcome = drive(*exchange, answers);
    EXPECT_TRUE(outcome.done()) << to_text(outcome);
    return outcome.sent.size() == 2 ? to_hex(outcome.sent[1]) : "";
  };
  EXPECT_EQ(run(acknowledged("00 01 4F 00 04 00 07 00")), kAck) << "late response";
  EXPECT_EQ(run(packet("00 02 4F 00 05 00 07 00")), kAck) << "another node";
  EXPECT_EQ(run(packet("00 01 0F 00 05 00 AA 02 07 89 00 00 07 00")), kAck) << "a MSG of the PLC";
}

TEST(Df1, ADamagedResponseIsRequestedAgain) {
  const Device device = plc();
  const Bytes whole = packet("00 01 4F 00 05 00 2A 00");
  Bytes damaged = whole;
  damaged[8] ^= 1;
  for (const Bytes& first : {damaged, Bytes(whole.begin(), whole.end() - 3), hex("10 06 10 05")}) {
    const auto exchange = device.begin(device.read("N7:0"), 5);
    const std::vector<Bytes> answers{first, whole};
    const Outcome outcome = drive(*exchange, answers);
    ASSERT_TRUE(outcome.done()) << to_text(outcome);
    EXPECT_EQ(to_hex(outcome.sent[1]), kNak);
  }
  const auto exchange = device.begin(device.read("N7:0"), 5);
  const std::vector<Bytes> never(10, damaged);
  const Outcome outcome = drive(*exchange, never);
  EXPECT_EQ(outcome.cause, Cause::kChecksum);
  EXPECT_EQ(outcome.sent.size(), 5u);
}

// A PLC sends no response before the one before is acknowledged, also if nobody received it.
TEST(Df1, AResponseThatDoesNotComeIsRequestedOnce) {
  const Device device = plc();
  const Bytes earlier = packet("00 01 4F 00 04 00 07 00"),
              whole = packet("00 01 4F 00 05 00 2A 00");
  const auto exchange = device.begin(device.read("N7:0"), 5);
  const std::vector<Bytes> answers{hex(kAck), earlier, whole};
  const Outcome outcome = drive(*exchange, answers);
  ASSERT_TRUE(outcome.done()) << to_text(outcome);
  ASSERT_EQ(outcome.sent.size(), 3u);
  EXPECT_EQ(to_hex(outcome.sent[1]), kNak);
  EXPECT_EQ(to_hex(outcome.sent[2]), kAck);

  const auto silent = device.begin(device.read("N7:0"), 5);
  const std::vector<Bytes> only_acknowledged{hex(kAck)};
  const Outcome nothing = drive(*silent, only_acknowledged);
  EXPECT_EQ(nothing.cause, Cause::kNoResponse);
  EXPECT_EQ(nothing.sent.size(), 2u);
}

TEST(Df1, ARefusedCommandIsSentAgain) {
  const Device device = plc();
  const auto exchange = device.begin(device.read("N7:0"), 5);
  const std::vector<Bytes> answers{hex(kNak), acknowledged("00 01 4F 00 05 00 2A 00")};
  const Outcome outcome = drive(*exchange, answers);
  ASSERT_TRUE(outcome.done()) << to_text(outcome);
  EXPECT_EQ(outcome.sent[0], outcome.sent[1]);
}

TEST(Df1, EmbeddedResponsesAreSkipped) {
  const Device device = plc();
  Bytes response = packet("00 01 4F 00 05 00 2A 00");
  const Bytes ack = hex(kAck);
  response.insert(response.begin() + 5, ack.begin(), ack.end());
  const auto exchange = device.begin(device.read("N7:0"), 5);
  EXPECT_TRUE(drive(*exchange, response).done());
}

TEST(Df1HalfDuplex, PollsUntilTheSlaveHasItsResponse) {
  const Device device = half_duplex();
  const Request read = device.read("N7:0");
  const std::vector<Bytes> answers{hex(kAck), hex("10 04"), hex("10 04"),
                                   packet("00 11 4F 00 05 00 2A 00")};
  const auto exchange = device.begin(read, 5);
  const Outcome outcome = drive(*exchange, answers);
  ASSERT_TRUE(outcome.done()) << to_text(outcome);
  ASSERT_EQ(outcome.sent.size(), 4u);
  EXPECT_EQ(to_hex(outcome.sent[1]), "10 05 11 EF") << "1770-6.5.16, 14-2";
  EXPECT_EQ(to_hex(outcome.confirmation), kAck);
  expect_matrix({.begin = [&] { return device.begin(read, 5); },
                 .answers = answers,
                 .noise_recovers = false});
}

TEST(Df1HalfDuplex, ADamagedResponseIsPolledAgain) {
  const Device device = half_duplex();
  Bytes damaged = packet("00 11 4F 00 05 00 2A 00");
  damaged[8] ^= 1;
  const std::vector<Bytes> answers{hex(kAck), damaged, packet("00 11 4F 00 05 00 2A 00")};
  const auto exchange = device.begin(device.read("N7:0"), 5);
  const Outcome outcome = drive(*exchange, answers);
  ASSERT_TRUE(outcome.done()) << to_text(outcome);
  EXPECT_EQ(to_hex(outcome.sent[2]), "10 05 11 EF");
}

// The responses of stations 2 and 1 at the same time. The check is the one of station 2 and right
// for the mixed packet, too.
TEST(Df1HalfDuplex, APacketBehindADamagedOneIsPolledAgain) {
  const Device device = half_duplex(1);
  const auto exchange = device.begin(device.read("N7:120"), 0x0195);
  const std::vector<Bytes> answers{
      hex(kAck), hex("10 02 00 02 4F 00 65 01 10 02 00 01 4F 00 95 01 F9 04 10 03 E0 19"),
      packet("00 01 4F 00 95 01 26 84")};
  const Outcome outcome = drive(*exchange, answers);
  ASSERT_TRUE(outcome.done()) << to_text(outcome);
  EXPECT_EQ(exchange->reply().at(0).items, hex("84 26"));
}

TEST(Df1HalfDuplex, ALateResponseIsRemovedFromTheSlave) {
  const Device device = half_duplex();
  const std::vector<Bytes> answers{hex(kAck), packet("00 11 4F 00 04 00 07 00"),
                                   packet("00 11 4F 00 05 00 2A 00")};
  const auto exchange = device.begin(device.read("N7:0"), 5);
  const Outcome outcome = drive(*exchange, answers);
  ASSERT_TRUE(outcome.done()) << to_text(outcome);
  EXPECT_EQ(to_hex(outcome.sent[2]), "10 06 10 05 11 EF") << "1770-6.5.16, 14-2";
}

TEST(Df1HalfDuplex, ASlaveThatIsNeverReadyIsBusy) {
  const Device device = half_duplex();
  std::vector<Bytes> answers(60, hex("10 04"));
  answers[0] = hex(kAck);
  const auto exchange = device.begin(device.read("N7:0"), 5);
  EXPECT_EQ(drive(*exchange, answers).cause, Cause::kDeviceBusy);
}

TEST(Df1, SizesAreThoseOfTheFrames) {
  for (const auto& options : {std::map<std::string, std::string>{}, {{"check", "bcc"}}}) {
    const Device device = plc(options);
    for (const Request& request :
         {device.read("N7:0"), device.read("N7:16", 8), device.read("N255:300"),
          device.write("N7:0", "10 10"), device.write_bit("N7:0/4", true),
          device.write_bit("N7:0/12", false)}) {
      const auto size = device.protocol().size(request);
      ASSERT_TRUE(size);
      const std::size_t sent = device.request_bytes(request, 0x1010).size();
      EXPECT_EQ(size->request_characters, sent + 2) << "with the confirmation";
    }
  }
}

TEST(Df1, LimitsAreThoseOfTheManual) {
  const Device device = plc();
  EXPECT_TRUE(device.protocol().size(device.read("N7:0", 118)));
  EXPECT_FALSE(device.protocol().size(device.read("N7:0", 119)));
  EXPECT_FALSE(device.protocol().size(device.read("N7:990", 20))) << "two files";
  EXPECT_TRUE(device.protocol().size(device.read("T4:0/EN", 117)));
  EXPECT_FALSE(device.protocol().size(device.read("T4:0.PRE", 117))) << "40 elements";
  EXPECT_FALSE(device.protocol().size(device.write("T4:0.PRE", "00 01 00 02")));
  EXPECT_FALSE(device.protocol().size(device.write("I:0.0", "00 01")));
  EXPECT_FALSE(device.protocol().size(device.write_bit("L9:0/3", true)));
  const Device small = plc({{"max-bytes", "82"}});
  EXPECT_TRUE(small.protocol().size(small.read("N7:0", 41)));
  EXPECT_FALSE(small.protocol().size(small.read("N7:0", 42)));
}

TEST(Df1Address, Notation) {
  const Device device = plc();
  expect_texts([&](const std::string& at) { return device.address(at); },
               {"N7:0 -> N:7000/0",
                "N7:1/15 -> N:7001.15/1",
                "N10:5 -> N:10005/0",
                "B3:1/5 -> B:3001.5/1",
                "B3/21 -> B:3001.5/1",
                "F8:3 -> F:8003/32",
                "L9:0/17 -> L:9000.17/1",
                "T4:0/EN -> T:12000.15/1",
                "T4:0.DN -> T:12000.13/1",
                "T4:1.PRE -> T:12004/0",
                "T4:1.ACC/3 -> T:12005.3/1",
                "T4:0/13 -> T:12000.13/1",
                "C5:0/UA -> C:15000.10/1",
                "R6:0.POS -> R:18002/0",
                "R6:0/FD -> R:18000.8/1",
                "S:1/15 -> S:1.15/1",
                "S2:4 -> S:4/0",
                "O:0.0 -> O:0/0",
                "O:0/3 -> O:0.3/1",
                "I:1.0/3 -> I:32.3/1",
                "I:1/17 -> I:33.1/1"});
}

TEST(Df1Address, FaultsAndSuggestions) {
  const Device device = plc();
  for (const std::string_view at : {"",
                                    "N",
                                    "N7",
                                    "N7:",
                                    "N:0",
                                    "N256:0",
                                    "N7:1000",
                                    "N7:0/16",
                                    "N7:0/",
                                    "N7:0.",
                                    "N7:x",
                                    "F8:0/1",
                                    "L9:0/32",
                                    "T4:0",
                                    "T4:0.",
                                    "T4:0/",
                                    "T4:0.LEN",
                                    "T4:0.EN/3",
                                    "T4:0.ACC/16",
                                    "R6:0.ACC",
                                    "S3:0",
                                    "S:256",
                                    "O1:0",
                                    "I:31.0",
                                    "I:0.32",
                                    "I:0.0/16",
                                    "B3/16000",
                                    "N7/3",
                                    "X1:0",
                                    ":0",
                                    "/",
                                    "7:0",
                                    "N7:0:0",
                                    "N-7:0",
                                    "N7:0/-1",
                                    "T4:0.ACC.PRE",
                                    "N99999999999:0"})
    EXPECT_FALSE(device.protocol().parse_address(at)) << at;
  expect_texts([&](const std::string& at) { return device.suggestion(at); },
               {"n7:0 -> N7:0", "N7:0.3 -> N7:0/3", "T4:0 -> T4:0.ACC", "R6:2.ACC -> R6:2.POS",
                "F8:0/1 -> F8:0", "N7:0/16 -> N7:0"});
}

TEST(Df1, Options) {
  const auto make = [](std::string_view name, const std::string& text) {
    return find_protocol("allen-bradley-df1")
        ->make({.address = 1, .options = {{std::string(name), text}}})
        .has_value();
  };
  EXPECT_TRUE(make("source", "254"));
  EXPECT_FALSE(make("source", "255"));
  EXPECT_FALSE(make("check", "sum"));
  EXPECT_FALSE(make("max-bytes", "237"));
  EXPECT_EQ(to_hex(ByteView(plc({{"source", "3"}}).request_bytes(plc().read("N7:0"))).first(6)),
            "10 02 01 03 0F 00");
}

TEST(Df1Explain, SaysWhatIsWrong) {
  EXPECT_EQ(value(packet("00 01 4F F0 05 00 0B"), "EXT STS"), "F00B access denied");
  EXPECT_EQ(value(packet("00 01 4F 70 05 00"), "STS"), "70 processor is in program mode");
  EXPECT_EQ(value(hex("10 05 11 EF"), "ENQ"), "poll of station 17");
  EXPECT_EQ(value(hex("10 05"), "ENQ"), "repeat the last ACK or NAK");
  EXPECT_EQ(value(packet("01 00 0F 00 05 00 A2 02 07 8A 00 00"), "type"), "8A F");
  Bytes damaged = packet("00 01 4F 00 05 00 2A 00");
  damaged.back() ^= 1;
  EXPECT_THAT(faults(explain(damaged)), testing::HasSubstr("should be CRC "));
  EXPECT_EQ(faults(explain(packet("01 00 0F 00 05 00 AA 04 07 89 00 00 2A 00"))),
            "should be 4 bytes;");
  EXPECT_EQ(faults(explain(hex("10 02 00 01"))),
            "a packet has six bytes at least;the packet does not end with 10 03;");
}

}  // namespace
}  // namespace fieldcast::test
