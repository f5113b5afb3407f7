#include <gtest/gtest.h>

#include "core/codec/checksum.hpp"
#include "core/codec/digits.hpp"
#include "core/protocol/families/registry.hpp"
#include "tests/support/device.hpp"
#include "tests/support/matrix.hpp"
#include "tests/support/vectors.hpp"

namespace fieldcast::test {
namespace {

std::string text(ByteView bytes) { return {bytes.begin(), bytes.end()}; }
Bytes framed(const std::string& body) {
  Bytes frame(body.begin(), body.end());
  const std::uint8_t fcs = xor8(frame);
  append_digits(frame, fcs, 2);
  frame.push_back('*');
  frame.push_back('\r');
  return frame;
}
Device plc(std::map<std::string, std::string> more = {}) {
  more["mode"] = "fins";
  return {"omron-hostlink", 0, more};
}
bool has_fault(const std::vector<FrameField>& fields) {
  return std::any_of(fields.begin(), fields.end(),
                     [](const FrameField& field) { return !field.fault.empty(); });
}
std::vector<FrameField> explain(const Bytes& frame) {
  return find_protocol("omron-hostlink")->explain(frame);
}
unsigned number(const std::string& digits) {
  return static_cast<unsigned>(std::stoul(digits, nullptr, 16));
}

// Parses a published direct request without the codec.
struct Meant {
  Device device;
  Request request;
  std::uint16_t sid;
};
std::optional<Meant> meant(const std::string& q) {
  static const std::map<unsigned, std::string> areas{{0xB0, "CIO"}, {0xB1, "W"},  {0xB2, "HR"},
                                                     {0xB3, "AR"},  {0x82, "DM"}, {0xA0, "E0_"}};
  if (!q.starts_with("@00FA") || q.size() < 30 || q.substr(6, 2) != "00") return std::nullopt;
  const std::string command = q.substr(14, 4);
  if (command != "0101" && command != "0102") return std::nullopt;
  const auto area = areas.find(number(q.substr(18, 2)));
  if (area == areas.end() || q.substr(24, 2) != "00")
    return std::nullopt;  // Fieldcast has no request for bits of several words
  Device device = plc({{"wait", std::to_string(number(q.substr(5, 1)))},
                       {"unit", std::to_string(number(q.substr(8, 2)))}});
  const std::string at = area->second + std::to_string(number(q.substr(20, 4)));
  const auto sid = static_cast<std::uint16_t>(number(q.substr(12, 2)));
  Request request = command == "0101" ? device.read(at, number(q.substr(26, 4)))
                                      : device.write(at, q.substr(30, q.size() - 34));
  if (!device.protocol().size(request)) return std::nullopt;
  return Meant{std::move(device), std::move(request), sid};
}

TEST(FinsVectors, OurRequestsAreTheirsAndTheirResponsesAreRead) {
  int requests = 0;
  int answers = 0;
  for (const GoldenVector& vector : load_vectors("fins")) {
    if (vector.framing != "hostlink" || vector.kind != "ok") continue;
    SCOPED_TRACE(vector.name);
    auto asked = meant(text(vector.request));
    if (!asked) continue;
    ++requests;
    EXPECT_EQ(text(asked->device.request_bytes(asked->request, asked->sid)), text(vector.request));
    if (vector.response.empty()) continue;
    ++answers;
    const auto exchange = asked->device.begin(asked->request, asked->sid);
    const Outcome outcome = drive(*exchange, vector.response);
    ASSERT_TRUE(outcome.done()) << to_text(outcome);
    expect_matrix({.begin = [&] { return asked->device.begin(asked->request, asked->sid); },
                   .answers = {vector.response}});
    const std::string data = text(vector.response).substr(23, vector.response.size() - 27);
    EXPECT_EQ(to_hex(outcome.reply[0].items, '\0'), data);
  }
  EXPECT_GE(requests, 8);
  EXPECT_GE(answers, 7);
}

TEST(FinsVectors, EndCodesAreTheDevicesErrors) {
  for (const GoldenVector& vector : load_vectors("fins")) {
    if (vector.framing != "hostlink" || vector.kind != "exception" || vector.name == "fa_end_0401")
      continue;  // of another command
    SCOPED_TRACE(vector.name);
    const Device device = plc();
    const std::string answer = text(vector.response);
    const auto sid =
        static_cast<std::uint16_t>(answer.size() > 15 ? number(answer.substr(13, 2)) : 0);
    const auto exchange = device.begin(device.read("DM0"), sid);
    const Outcome outcome = drive(*exchange, vector.response);
    const bool host_link_level = answer.substr(5, 2) != "00";
    EXPECT_EQ(outcome.code,
              number(host_link_level ? answer.substr(5, 2) : answer.substr(19, 4)) & 0x7FFF);
    // A wrong FCS is a line error, so the request is retried. The CPU mode and errors, and a busy
    // or silent destination, are temporary states.
    static const std::set<int> kLine{0x13, 0xA3},
        kMoment{0x01, 0x02, 0x0B, 0x21, 0x2502, 0x3001, 0x4001}, kClasses{0x01, 0x02, 0x03, 0x22};
    const bool moment = kMoment.contains(outcome.code) || kClasses.contains(outcome.code >> 8);
    EXPECT_EQ(outcome.cause, kLine.contains(outcome.code) ? Cause::kChecksum
                             : moment                     ? Cause::kDeviceBusy
                                                          : Cause::kDeviceError);
  }
}

TEST(FinsVectors, WhatIsMalformedHasNoValue) {
  int seen = 0;
  for (const GoldenVector& vector : load_vectors("fins")) {
    if (vector.framing != "hostlink" || vector.kind != "malformed" || vector.response.empty())
      continue;
    SCOPED_TRACE(vector.name);
    ++seen;
    const Device device = plc();
    EXPECT_FALSE(drive(*device.begin(device.read("DM0")), vector.response).done());
  }
  EXPECT_GE(seen, 1);
}

// Datagrams and frames of TCP are those of omron-fins. Fieldcast does not have Toolbus.
TEST(FinsVectors, FramesOfEthernetAreExplained) {
  int seen = 0;
  for (const GoldenVector& vector : load_vectors("fins")) {
    if (vector.framing != "raw" && vector.framing != "tcp") continue;
    SCOPED_TRACE(vector.name);
    for (const Bytes& frame : {vector.request, vector.response}) {
      if (frame.empty()) continue;
      ++seen;
      EXPECT_EQ(has_fault(find_protocol("omron-fins")->explain(frame)), vector.kind == "malformed");
    }
  }
  EXPECT_GE(seen, 18);
}

TEST(Fins, TheMatrixOfARefusalHolds) {
  const Device device = plc();
  expect_matrix({.begin = [&] { return device.begin(device.read("DM0")); },
                 .answers = {framed("@00FA004000000001011103")}});
}

TEST(FinsVectors, ExplanationsFindTheFaults) {
  for (const GoldenVector& vector : load_vectors("fins")) {
    if (vector.framing != "hostlink") continue;
    SCOPED_TRACE(vector.name);
    if (vector.kind == "ok" && !vector.request.empty()) {
      EXPECT_FALSE(has_fault(explain(vector.request)));
    }
    if (!vector.response.empty()) {
      EXPECT_EQ(has_fault(explain(vector.response)), vector.kind == "malformed");
    }
  }
}

TEST(Fins, ScatteredWordsComeInOneRequest) {
  const Device device = plc();
  const Request request =
      ReadRequest{{device.range("DM100"), device.range("W10"), device.range("TF5", 2)}};
  EXPECT_EQ(text(device.request_bytes(request)),
            text(framed("@00FA000000000010482006400B1000A0009000500"
                        "09000600")));
  const Bytes answer = framed(
      "@00FA00400000000104000082"
      "1234"
      "B1"
      "5678"
      "0901"
      "0900");
  const auto exchange = device.begin(request);
  const Outcome outcome = drive(*exchange, answer);
  ASSERT_TRUE(outcome.done()) << to_text(outcome);
  ASSERT_EQ(outcome.reply.size(), 3u);
  EXPECT_EQ(to_hex(outcome.reply[0].items), "12 34");
  EXPECT_EQ(to_hex(outcome.reply[1].items), "56 78");
  EXPECT_EQ(to_hex(outcome.reply[2].items), "01 00");
  const auto size = device.protocol().size(request);
  ASSERT_TRUE(size.has_value());
  EXPECT_EQ(size->request_characters, device.request_bytes(request).size());
  EXPECT_EQ(size->response_characters, answer.size());
  expect_matrix({.begin = [&] { return device.begin(request); }, .answers = {answer}});
  expect_random_bytes_are_refused(
      {.begin = [&] { return device.begin(request); }, .answers = {answer}}, 5, 5000);
}

TEST(Fins, AnItemOfAnotherAreaIsNotAResponse) {
  const Device device = plc();
  const auto exchange = device.begin(ReadRequest{{device.range("DM100"), device.range("W10")}});
  EXPECT_EQ(drive(*exchange, framed("@00FA0040000000010400008212348256"
                                    "78"))
                .cause,
            Cause::kMalformed);
}

TEST(Fins, OneBitIsWrittenAlone) {
  const Device device = plc();
  EXPECT_EQ(text(device.request_bytes(device.write_bit("CIO100.05", true))),
            text(framed("@00FA0000000000102300064050001"
                        "01")));
  EXPECT_EQ(text(device.request_bytes(device.write_bit("E1_2.15", false))),
            text(framed("@00FA000000000010221"
                        "00020F0001"
                        "00")));
  EXPECT_FALSE(device.protocol().size(device.write_bit("T5", true)).has_value() &&
               device.range("T5").area == 0);
}

TEST(Fins, AResponseToAnEarlierRequestIsPassedOver) {
  const Device device = plc();
  const auto exchange = device.begin(device.read("DM0"), 7);
  Bytes stream = framed(
      "@00FA004000000601010000"
      "1111");
  append(stream, framed("@00FA004000000701010000"
                        "2222"));
  const Outcome outcome = drive(*exchange, stream);
  ASSERT_TRUE(outcome.done());
  EXPECT_EQ(to_hex(outcome.reply[0].items), "22 22");
}

TEST(Fins, ARelayedRequestCarriesTheWholeHeader) {
  const Device device = plc({{"network", "5"}, {"node", "3"}});
  EXPECT_EQ(text(device.request_bytes(device.read("DM0"))),
            text(framed("@00FA0800002050300000000000101820000000001")));
  const auto exchange = device.begin(device.read("DM0"));
  const Outcome outcome = drive(*exchange, framed("@00FA00C00002000000050300000101000000FF"));
  ASSERT_TRUE(outcome.done()) << to_text(outcome);
  EXPECT_EQ(to_hex(outcome.reply[0].items), "00 FF");
}

// Bit 7 of the end code, and the node behind it (W227, 5-1): its code is that of the table.
TEST(Fins, ARelayThatGotNoResponseLeavesAWriteInDoubt) {
  const Device device = plc({{"network", "5"}, {"node", "3"}});
  const auto exchange = device.begin(device.write("DM0", "00FF"));
  const Outcome outcome = drive(*exchange, framed("@00FA00C0000200000005030000010282050503"));
  EXPECT_EQ(outcome.cause, Cause::kDeviceBusy);
  EXPECT_EQ(outcome.code, 0x0205);
  const auto codes = device.protocol().traits().codes;
  EXPECT_TRUE(may_have_written(codes, outcome.code));
  EXPECT_EQ(device_code_text(codes, outcome.code), "destination did not respond");
}

// FINS 0001 has the number of Host Link 01, a refusal in RUN mode (W227, 5-1; W342, 4-3).
TEST(Fins, AnInterruptedServiceLeavesAWriteInDoubt) {
  const Device device = plc();
  const auto exchange = device.begin(device.write("DM0", "00FF"));
  const Outcome outcome = drive(*exchange, framed("@00FA004000000001020001"));
  EXPECT_EQ(outcome.cause, Cause::kDeviceBusy);
  EXPECT_EQ(outcome.code, 0x0001);
  const auto codes = device.protocol().traits().codes;
  EXPECT_TRUE(may_have_written(codes, outcome.code));
  EXPECT_EQ(device_code_text(codes, outcome.code), "service interrupted");
}

TEST(Fins, ARangeAcrossTwoBanksIsRefused) {
  const Device device = plc();
  EXPECT_TRUE(device.protocol().size(device.read("E0_32766", 2)).has_value());
  EXPECT_FALSE(device.protocol().size(device.read("E0_32766", 3)).has_value());
  EXPECT_FALSE(device.protocol().size(device.read("DM0", 265)).has_value());
}

TEST(Fins, OptionsOfFinsBelongToFins) {
  const auto made =
      find_protocol("omron-hostlink")->make({.address = 0, .options = {{"wait", "3"}}});
  ASSERT_FALSE(made.has_value());
  EXPECT_EQ(made.error().option, "wait");
}

}  // namespace
}  // namespace fieldcast::test
