#include <gtest/gtest.h>

#include "core/codec/checksum.hpp"
#include "core/protocol/families/registry.hpp"
#include "core/protocol/s7_ppi/telegram.hpp"
#include "tests/support/device.hpp"
#include "tests/support/matrix.hpp"
#include "tests/support/text_cases.hpp"
#include "tests/support/vectors.hpp"

namespace fieldcast::test {
namespace {

Bytes hex(std::string_view text) { return *from_hex(text); }
Device plc(std::uint16_t station = 2, std::map<std::string, std::string> options = {}) {
  return {"s7-ppi", station, options};
}
bool has_fault(const std::vector<FrameField>& fields) {
  return std::any_of(fields.begin(), fields.end(),
                     [](const FrameField& field) { return !field.fault.empty(); });
}
std::vector<FrameField> explain(const Bytes& frame) {
  return find_protocol("s7-ppi")->explain(frame);
}

// Builds a telegram around a unit, independently of the codec.
Bytes telegram(std::uint8_t to, std::uint8_t from, std::uint8_t control, const Bytes& unit) {
  Bytes body{to, from, control};
  append(body, unit);
  const auto length = static_cast<std::uint8_t>(body.size());
  Bytes frame{0x68, length, length, 0x68};
  append(frame, body);
  frame.push_back(sum8(body));
  frame.push_back(0x16);
  return frame;
}

const std::map<int, std::string> kAreaNames{{0x81, "I"}, {0x82, "Q"}, {0x83, "M"}, {0x84, "V"}};
std::string place(int area, unsigned address) {
  if (area == 0x1F) return "T" + std::to_string(address);
  return kAreaNames.at(area) + "B" + std::to_string(address / 8);
}

// Parses a published read or write without the codec: all as bytes, bits where a bit is written.
std::optional<Request> meant(const Device& device, const Bytes& q) {
  if (q.size() < 31 || q[0] != 0x68 || q[8] != 0x01) return std::nullopt;
  const int function = q[17];
  const std::size_t items = q[18];
  ReadRequest read;
  for (std::size_t i = 0; i < items; ++i) {
    const std::size_t at = 19 + 12 * i;
    if (at + 12 > q.size()) return std::nullopt;
    const int area = q[at + 8];
    const unsigned address = q[at + 9] * 65536u + q[at + 10] * 256u + q[at + 11];
    const unsigned count = read_u16(q, at + 4);
    const int type = q[at + 3];
    if (!kAreaNames.contains(area) && !(area == 0x1F && type == 0x1F)) return std::nullopt;
    if (type == 1 && function == 4) return std::nullopt;  // bits are read with their byte
    const unsigned bytes = type == 4 ? 2 * count : type == 6 ? 4 * count : count;
    if (!device.protocol().parse_address(place(area, address))) return std::nullopt;
    if (function == 4) {
      read.ranges.push_back(device.range(place(area, address), bytes));
      continue;
    }
    const std::size_t data = at + 12 + 4;
    if (type == 1)
      return device.write_bit(
          kAreaNames.at(area) + std::to_string(address / 8) + "." + std::to_string(address % 8),
          q[data] != 0);
    return device.write(place(area, address), to_hex(ByteView(q).subspan(data, bytes)));
  }
  if (function != 4 || read.ranges.empty()) return std::nullopt;
  return read;
}

// Normalises to bytes, without the fill byte, with the control byte that Fieldcast sends.
Bytes normalised(Bytes q) {
  Bytes unit(q.begin() + 7, q.end() - 2);
  const std::size_t items = unit[11];
  const bool write = unit[10] == 5;
  for (std::size_t i = 0; i < items; ++i) {
    std::uint8_t* item = unit.data() + 12 + 12 * i;
    if (item[3] == 4 || item[3] == 6) {
      item[5] = static_cast<std::uint8_t>(item[5] * (item[3] == 4 ? 2 : 4));
      item[3] = 2;
    }
  }
  if (write) {
    const std::size_t bits = read_u16(unit, 26);
    const std::size_t size = unit[25] == 3 ? 1 : bits / 8;
    unit.resize(28 + size);
    unit[9] = static_cast<std::uint8_t>(4 + size);
  }
  const unsigned reference = read_u16(unit, 4);
  return telegram(q[4], q[5], reference == 0 ? 0x6C : reference % 2 != 0 ? 0x5C : 0x7C, unit);
}

TEST(PpiVectors, OurRequestsAreTheirsAndTheirResponsesAreRead) {
  int requests = 0;
  int answers = 0;
  for (const GoldenVector& vector : load_vectors("ppi")) {
    if (vector.kind != "ok" || vector.request.empty()) continue;
    SCOPED_TRACE(vector.name);
    const Device device = plc();
    const auto request = meant(device, vector.request);
    if (!request) continue;
    ++requests;
    const std::uint16_t reference = read_u16(vector.request, 11);
    EXPECT_EQ(to_hex(device.request_bytes(*request, reference)),
              to_hex(normalised(vector.request)));
    if (vector.slave.empty()) continue;
    ++answers;
    const auto exchange = device.begin(*request, reference);
    const Outcome outcome = drive(*exchange, vector.slave);
    ASSERT_TRUE(outcome.done()) << to_text(outcome);
    ASSERT_EQ(outcome.sent.size(), 2u);
    expect_matrix(
        {.begin = [&] { return device.begin(*request, reference); }, .answers = vector.slave});
    if (outcome.sent[0][6] == vector.request[6]) {
      EXPECT_EQ(to_hex(outcome.sent[1]), to_hex(vector.master[1]));  // poll
    }
    const auto* read = std::get_if<ReadRequest>(&*request);
    if (read == nullptr || read->ranges.size() != 1) continue;
    // Data begin after the item header; timers keep the last four of five bytes.
    const Bytes& last = vector.response;
    Bytes data(last.begin() + 25, last.end() - 2);
    if (vector.request[27] == 0x1F) {
      Bytes values;
      for (std::size_t i = 0; i < data.size(); i += 5)
        append(values, ByteView(data).subspan(i + 1, 4));
      data = values;
    }
    EXPECT_EQ(to_hex(outcome.reply[0].items), to_hex(data));
  }
  EXPECT_GE(requests, 20);
  EXPECT_GE(answers, 15);
}

TEST(PpiVectors, RefusalsAreTheirCodes) {
  const std::map<std::string, int> codes{{"read_t_as_bytes_error", 3}, {"write_protected", 3}};
  for (const GoldenVector& vector : load_vectors("ppi")) {
    if (!codes.contains(vector.name)) continue;
    SCOPED_TRACE(vector.name);
    const Device device = plc();
    const bool write = vector.request[17] == 5;
    const auto exchange = device.begin(write ? device.write("QB0", "01") : device.read("MB0"),
                                       read_u16(vector.request, 11));
    const Outcome outcome = drive(*exchange, vector.slave);
    EXPECT_EQ(outcome.cause, Cause::kDeviceError);
    EXPECT_EQ(outcome.code, codes.at(vector.name));
    expect_matrix({.begin =
                       [&] {
                         return device.begin(write ? device.write("QB0", "01") : device.read("MB0"),
                                             read_u16(vector.request, 11));
                       },
                   .answers = vector.slave});
  }
}

TEST(PpiVectors, OneItemMayFailWhileAnotherSucceeds) {
  for (const GoldenVector& vector : load_vectors("ppi")) {
    if (vector.name != "read_multi_mixed_error") continue;
    const Device device = plc();
    const auto exchange =
        device.begin(ReadRequest{{device.range("VB0"), device.range("VB10239")}}, 5);
    const Outcome outcome = drive(*exchange, vector.slave);
    ASSERT_TRUE(outcome.done());
    ASSERT_EQ(outcome.reply.size(), 2u);
    EXPECT_EQ(to_hex(outcome.reply[0].items), "55");
    EXPECT_EQ(outcome.reply[1].cause, Cause::kDeviceError);
    EXPECT_EQ(outcome.reply[1].device_code, 5);
    return;
  }
  FAIL() << "the vector is missing";
}

TEST(PpiVectors, ExplanationsFindTheFaults) {
  for (const GoldenVector& vector : load_vectors("ppi")) {
    SCOPED_TRACE(vector.name);
    if (vector.kind != "malformed") {
      for (const Bytes& each : {vector.request, vector.response}) {
        if (!each.empty()) { EXPECT_FALSE(has_fault(explain(each))); }
      }
    } else if (!vector.request.empty() && vector.expect != "accept_tail" &&
               vector.expect != "ok_frame_wrong_ref") {
      EXPECT_TRUE(has_fault(explain(vector.request)));
    }
  }
}

const Bytes kAck{0xE5};
// VB100..102 = 99 34 56, captured.
const Bytes kAnswer = hex("68181868 0002 08 320300000000000200070000 0401 FF040018 993456 8B 16");

// EN 50170 (FDL), part 3, 4.6: start, the length twice, start; sum and 16. A telegram has at most
// 255 bytes.
TEST(PpiTelegram, IsRecognizedByItsHeadAndItsEnd) {
  using Kind = s7_ppi::Telegram::Kind;
  struct Row {
    std::string_view bytes;
    Kind kind;
    std::size_t size;  // of the telegram; 1: the search continues with the next byte
  };
  for (const Row& row : {Row{"68", Kind::kOpen, 9},
                         {"68 04", Kind::kOpen, 9},
                         {"68 04 04", Kind::kOpen, 9},
                         {"68 04 04 68", Kind::kOpen, 10},
                         {"68 03", Kind::kOpen, 9},
                         {"68 02", Kind::kNoise, 1},
                         {"68 F9", Kind::kOpen, 9},
                         {"68 FA", Kind::kNoise, 1},
                         {"68 04 05", Kind::kNoise, 1},
                         {"68 04 04 69", Kind::kNoise, 1},
                         {"68 04 04 68 02 00 6C 32 A0", Kind::kOpen, 10},
                         {"68 04 04 68 02 00 6C 32 A0 16", Kind::kLong, 10},
                         {"68 04 04 68 02 00 6C 32 A0 16 E5", Kind::kLong, 10},
                         {"68 04 04 68 02 00 6C 32 A1 16", Kind::kBroken, 1},
                         {"68 04 04 68 02 00 6C 32 A0 17", Kind::kBroken, 1},
                         {"10", Kind::kOpen, 6},
                         {"10 02 00 5C 5E", Kind::kOpen, 6},
                         {"10 02 00 5C 5E 16", Kind::kShort, 6},
                         {"10 02 00 5C 5F 16", Kind::kBroken, 1},
                         {"10 02 00 5C 5E 17", Kind::kBroken, 1},
                         {"DC", Kind::kOpen, 3},
                         {"DC 7E", Kind::kOpen, 3},
                         {"DC 7F", Kind::kNoise, 1},
                         {"DC 7E 7F", Kind::kNoise, 1},
                         {"DC 7E 7E", Kind::kToken, 3},
                         {"E5", Kind::kAcknowledge, 1},
                         {"16", Kind::kNoise, 1}}) {
    const s7_ppi::Telegram telegram = s7_ppi::parse_telegram(*from_hex(row.bytes));
    EXPECT_EQ(telegram.kind, row.kind) << row.bytes;
    EXPECT_EQ(telegram.size, row.size) << row.bytes;
  }
}

TEST(PpiExchange, AcknowledgeIsFollowedByPollAfterARest) {
  const Device device = plc(2, {{"poll-delay-ms", "25"}});
  const auto exchange = device.begin(device.read("VB100", 3));
  Bytes out;
  EXPECT_EQ(exchange->start(out).characters, 1u);
  out.clear();
  const Step rest = exchange->on_bytes(kAck, out);
  EXPECT_EQ(rest.wait, Wait::kPause);
  EXPECT_EQ(rest.pause, std::chrono::milliseconds{25});
  const Step poll = exchange->on_silence(out);
  EXPECT_EQ(poll.kind, Step::Kind::kSend);
  EXPECT_EQ(poll.characters, kAnswer.size());
  EXPECT_EQ(to_hex(out), "10 02 00 5C 5E 16");
}

TEST(PpiExchange, SizesAreExact) {
  const Device device = plc();
  for (const Request& request :
       {device.read("VB100", 3), device.write("VB100", "0102"), device.write_bit("M0.1", true),
        Request{ReadRequest{{device.range("VB0"), device.range("T37"), device.range("AIW4")}}}}) {
    const auto size = device.protocol().size(request);
    ASSERT_TRUE(size.has_value());
    EXPECT_EQ(size->request_characters, device.request_bytes(request).size() + 6);
    EXPECT_EQ(size->rounds, 2u);
  }
  EXPECT_EQ(device.protocol().size(device.read("VB100", 3))->response_characters,
            1 + kAnswer.size());
}

TEST(PpiExchange, NotReadyIsPolledAgainWithTheOtherBit) {
  const Device device = plc();
  const auto exchange = device.begin(device.read("VB100", 3));
  const std::vector<Bytes> answers{kAck, kAck, kAck, kAnswer};
  const Outcome outcome = drive(*exchange, answers);
  ASSERT_TRUE(outcome.done());
  ASSERT_EQ(outcome.sent.size(), 4u);
  EXPECT_EQ(outcome.sent[1][3], 0x5C);
  EXPECT_EQ(outcome.sent[2][3], 0x7C);
  EXPECT_EQ(outcome.sent[3][3], 0x5C);
}

TEST(PpiExchange, ASlaveThatIsNeverReadyIsBusy) {
  const Device device = plc();
  const auto exchange = device.begin(device.read("VB100", 3));
  const std::vector<Bytes> answers(20, kAck);
  const Outcome outcome = drive(*exchange, answers);
  EXPECT_EQ(outcome.cause, Cause::kDeviceBusy);
  EXPECT_EQ(outcome.sent.size(), 11u);
  const auto refused = device.begin(device.read("VB100", 3));
  EXPECT_EQ(drive(*refused, hex("10 00 02 02 04 16")).cause, Cause::kDeviceBusy);
}

TEST(PpiExchange, AResponseWithoutOrGluedToItsAcknowledgeIsTaken) {
  const Device device = plc();
  const auto direct = device.begin(device.read("VB100", 3));
  EXPECT_TRUE(drive(*direct, kAnswer).done());
  Bytes glued = kAck;
  append(glued, kAnswer);
  const auto late = device.begin(device.read("VB100", 3));
  EXPECT_TRUE(drive(*late, glued).done());
}

TEST(PpiExchange, OtherStationsAndOlderResponsesArePassedOver) {
  const Device device = plc();
  Bytes other = kAnswer;
  other[5] = 3;  // from station 3
  other[other.size() - 2] = static_cast<std::uint8_t>(other[other.size() - 2] + 1);
  const auto exchange = device.begin(device.read("VB100", 3));
  const std::vector<Bytes> foreign{kAck, other};
  EXPECT_EQ(drive(*exchange, foreign).cause, Cause::kForeign);
  const auto newer = device.begin(device.read("VB100", 3), 1);
  const std::vector<Bytes> stale{kAck, kAnswer};
  EXPECT_EQ(drive(*newer, stale).cause, Cause::kForeign);
}

TEST(PpiExchange, TheMatrixHolds) {
  const Device device = plc();
  MatrixCase read{.begin = [&] { return device.begin(device.read("VB100", 3)); },
                  .answers = {kAck, kAnswer}};
  expect_matrix(read);
  expect_random_bytes_are_refused(read, 9, 5000);
  const Bytes written = hex("68121268 0002 08 320300000000000200010000 0501 FF 47 16");
  expect_matrix({.begin = [&] { return device.begin(device.write("VB100", "12")); },
                 .answers = {kAck, written}});
}

TEST(PpiLimits, WhatDoesNotFitTheUnitIsRefused) {
  const Device device = plc();
  EXPECT_TRUE(device.protocol().size(device.read("VB0", 222)).has_value());
  EXPECT_FALSE(device.protocol().size(device.read("VB0", 223)).has_value());
  ReadRequest many;
  for (std::uint32_t i = 0; i < 19; ++i)
    many.ranges.push_back(device.range("VB" + std::to_string(10 * i), 1));
  EXPECT_TRUE(device.protocol().size(many).has_value());
  many.ranges.back().count = 150;
  EXPECT_FALSE(device.protocol().size(many).has_value());
  many.ranges.assign(20, device.range("VB0"));
  EXPECT_FALSE(device.protocol().size(many).has_value());
  EXPECT_FALSE(device.protocol().size(device.write("IB0", "01")).has_value());
}

TEST(PpiAddress, NotationsAreUnderstood) {
  const Device device = plc();
  const auto name = [&](std::string_view at) { return device.address(at); };
  expect_texts(name, {"VB100 -> V:100/8", "VW100 -> V:100/16", "VD204 -> V:204/32",
                      "V10.3 -> V:10.3/1", "I0.3 -> I:0.3/1", "SMB28 -> SM:28/8",
                      "SM0.1 -> SM:0.1/1", "S0.1 -> S:0.1/1", "AIW4 -> AI:2/16", "AQW0 -> AQ:0/16",
                      "T37 -> T:37/0", "C5 -> C:5/0", "HC0 -> HC:0/0"});
}

TEST(PpiAddress, FaultsSayWhatWasMeant) {
  const Device device = plc();
  const auto suggestion = [&](std::string_view at) { return device.suggestion(at); };
  expect_texts(suggestion, {"vw100 -> VW100", "EB0 -> IB0", "AB0 -> QB0", "V100 -> VB100",
                            "AIW3 -> AIW2", "V1.8 -> V1.0", "VB1.0 -> VB1"});
  for (const auto* at : {"", "VB", "VB10240", "VBx", "X1", "T256", "TB1", "V.1", "VB-1", "HC6"})
    EXPECT_NE(suggestion(at), "-") << at;
}

TEST(PpiExplain, AcknowledgementsAloneAreNoFaults) {
  for (const auto* right : {"E5", "F9", "E5 10 02 00 5C 5E 16", "DC 02 00"})
    EXPECT_FALSE(has_fault(explain(*from_hex(right)))) << right;
}

}  // namespace
}  // namespace fieldcast::test
