#include <gtest/gtest.h>

#include "core/codec/checksum.hpp"
#include "core/codec/digits.hpp"
#include "core/protocol/families/registry.hpp"
#include "tests/support/device.hpp"
#include "tests/support/matrix.hpp"
#include "tests/support/text_cases.hpp"
#include "tests/support/vectors.hpp"

namespace fieldcast::test {
namespace {

std::string text(ByteView bytes) { return {bytes.begin(), bytes.end()}; }
// Returns "@00RD.." with FCS and the end mark of a last or a continued frame.
Bytes framed(const std::string& body, bool last = true) {
  Bytes frame(body.begin(), body.end());
  const std::uint8_t fcs = xor8(frame);
  append_digits(frame, fcs, 2);
  for (const char c : std::string(last ? "*\r" : "\r"))
    frame.push_back(static_cast<std::uint8_t>(c));
  return frame;
}
Device plc(std::uint16_t unit = 0) { return {"omron-hostlink", unit}; }

bool has_fault(const std::vector<FrameField>& fields) {
  return std::any_of(fields.begin(), fields.end(),
                     [](const FrameField& field) { return !field.fault.empty(); });
}
std::vector<FrameField> explain(const Bytes& frame) {
  return find_protocol("omron-hostlink")->explain(frame);
}

// The frames of a dialogue, or the request alone.
std::vector<Bytes> sent_frames(const GoldenVector& vector) {
  return vector.master.empty() ? std::vector<Bytes>{vector.request} : vector.master;
}

// Parses without the codec; `std::nullopt` for commands that Fieldcast does not send.
struct Meant {
  std::uint16_t unit;
  Request request;
};
std::optional<Meant> meant(const GoldenVector& vector) {
  static const std::map<char, std::string> areas{
      {'R', "CIO"}, {'L', "LR"}, {'H', "HR"}, {'J', "AR"}, {'D', "DM"}, {'C', "T"}, {'G', "TF"}};
  std::string q;
  for (const Bytes& frame : sent_frames(vector)) {
    const std::string each = text(frame);
    const std::size_t end = each.find('*') != std::string::npos ? 4 : 3;
    if (each.size() > end) q += each.substr(0, each.size() - end);
  }
  if (q.size() < 9 || q[0] != '@' || (q[3] != 'R' && q[3] != 'W') || !areas.contains(q[4]))
    return std::nullopt;
  const auto unit = static_cast<std::uint16_t>(std::stoul(q.substr(1, 2)));
  const std::string rest = q.substr(5);
  if (rest.size() < 8) return std::nullopt;
  const std::size_t number = std::stoul(rest.substr(0, 4));
  const bool counter = number >= 2048 && (q[4] == 'C' || q[4] == 'G');
  const std::string at = counter ? (q[4] == 'C' ? "C" : "CF") + std::to_string(number - 2048)
                                 : areas.at(q[4]) + std::to_string(number);
  const Device device = plc(unit);
  if (q[3] == 'R')
    return Meant{unit, device.read(at, static_cast<std::uint32_t>(std::stoul(rest.substr(4, 4))))};
  return Meant{unit, device.write(at, rest.substr(4))};
}

TEST(HostLinkVectors, OurRequestsAreTheirs) {
  int seen = 0;
  for (const GoldenVector& vector : load_vectors("hostlink")) {
    if (vector.kind != "ok") continue;
    SCOPED_TRACE(vector.name);
    const auto request = meant(vector);
    if (!request) continue;
    ++seen;
    EXPECT_EQ(text(plc(request->unit).request_bytes(request->request)),
              text(sent_frames(vector).front()));
  }
  EXPECT_GE(seen, 25);
}

TEST(HostLinkVectors, TheirResponsesAreRead) {
  int seen = 0;
  for (const GoldenVector& vector : load_vectors("hostlink")) {
    if (vector.kind != "ok" || vector.response.empty()) continue;
    SCOPED_TRACE(vector.name);
    const auto request = meant(vector);
    if (!request) continue;
    ++seen;
    const Device device = plc(request->unit);
    const auto exchange = device.begin(request->request);
    const auto answers = vector.slave.empty() ? std::vector<Bytes>{vector.response} : vector.slave;
    const Outcome outcome = drive(*exchange, answers);
    ASSERT_TRUE(outcome.done()) << to_text(outcome);
    if (!vector.master.empty()) { EXPECT_EQ(outcome.sent, vector.master); }
    const bool write = std::holds_alternative<WriteRequest>(request->request);
    // An `@` before a delimiter may begin a refusal.
    expect_matrix({.begin = [&] { return device.begin(request->request); },
                   .answers = answers,
                   .noise_recovers = !write || answers.size() == 1});
    if (write) continue;
    std::string digits;
    for (std::size_t i = 0; i < answers.size(); ++i) {
      const std::string frame = text(answers[i]);
      const std::size_t head = i == 0 ? 7 : 0;
      const std::size_t end =
          frame.find('*') != std::string::npos ? frame.size() - 4 : frame.size() - 3;
      digits += frame.substr(head, end - head);
    }
    std::string items;
    for (const std::uint8_t byte : outcome.reply.at(0).items) {
      items += vector.request[4] == 'G' ? std::string(1, static_cast<char>('0' + byte))
                                        : to_hex({&byte, 1}, '\0');
    }
    EXPECT_EQ(items, digits);
  }
  EXPECT_GE(seen, 15);
}

TEST(HostLinkVectors, EndCodesAreTheDevicesErrors) {
  for (const GoldenVector& vector : load_vectors("hostlink")) {
    if (vector.kind != "exception") continue;
    SCOPED_TRACE(vector.name);
    const std::string answer = text(vector.response);
    const Device device = plc();
    const auto exchange =
        device.begin(answer[3] == 'W' ? device.write("DM0", "0001") : device.read("DM0"));
    const Outcome outcome = drive(*exchange, vector.response);
    // A wrong FCS is a line error, so it is retried. CPU mode and errors are temporary states.
    static const std::set<std::string> kLine{"13", "A3"}, kMoment{"01", "02", "0B", "21"};
    const std::string end = answer[3] == 'I' ? "" : answer.substr(5, 2);
    EXPECT_EQ(outcome.cause, kLine.contains(end)     ? Cause::kChecksum
                             : kMoment.contains(end) ? Cause::kDeviceBusy
                                                     : Cause::kDeviceError);
    EXPECT_EQ(outcome.code, answer[3] == 'I'
                                ? 0x16
                                : static_cast<int>(std::stoul(answer.substr(5, 2), nullptr, 16)));
    EXPECT_FALSE(has_fault(explain(vector.response)));
  }
}

TEST(HostLinkVectors, ExplanationsFindTheFaults) {
  for (const GoldenVector& vector : load_vectors("hostlink")) {
    SCOPED_TRACE(vector.name);
    if (vector.kind == "ok") {
      for (const Bytes& frame : sent_frames(vector)) EXPECT_FALSE(has_fault(explain(frame)));
      if (!vector.response.empty()) {
        for (const Bytes& answer :
             vector.slave.empty() ? std::vector<Bytes>{vector.response} : vector.slave) {
          EXPECT_FALSE(has_fault(explain(answer)));
        }
      }
    }
    // A frame of another unit and an incomplete frame have no fault by themselves.
    if (vector.kind == "malformed" && vector.expect != "wrong_node" && vector.expect != "format") {
      EXPECT_TRUE(has_fault(explain(vector.request)));
    }
  }
}

TEST(HostLink, SizesAreExact) {
  const Device device = plc(10);
  for (const std::uint32_t count : {1u, 30u, 31u, 61u, 62u, 100u, 247u}) {
    const auto size = device.protocol().size(device.read("DM0", count));
    ASSERT_TRUE(size.has_value());
    std::vector<Bytes> answers;
    std::uint32_t left = count;
    std::size_t characters = 0;
    for (std::uint32_t room = 30; left > 0; room = 31) {
      const std::uint32_t words = std::min(left, room);
      left -= words;
      std::string body = answers.empty() ? "@10RD00" : "";
      for (std::uint32_t i = 0; i < words; ++i) body += "12AB";
      answers.push_back(framed(body, left == 0));
      characters += answers.back().size();
    }
    const auto exchange = device.begin(device.read("DM0", count));
    const Outcome outcome = drive(*exchange, answers);
    ASSERT_TRUE(outcome.done()) << count << ": " << to_text(outcome);
    EXPECT_EQ(size->rounds, answers.size());
    EXPECT_EQ(size->response_characters, characters);
    std::size_t sent = 0;
    for (const Bytes& each : outcome.sent) sent += each.size();
    EXPECT_EQ(size->request_characters, sent);
  }
  EXPECT_FALSE(device.protocol().size(device.read("DM0", 248)).has_value());
  EXPECT_FALSE(device.protocol().size(device.read("DM9999", 2)).has_value());
}

// EM AREA READ and WRITE have the number of the bank before the word.
TEST(HostLink, EmIsReadAndWrittenWithItsBank) {
  const Device device = plc();
  EXPECT_EQ(device.request_bytes(device.read("EM1_100", 2)), framed("@00RE0101000002"));
  EXPECT_EQ(device.request_bytes(device.read("EM9_9999")), framed("@00RE0999990001"));
  EXPECT_EQ(device.request_bytes(device.write("E0_7", "ABCD")), framed("@00WE000007ABCD"));
}

TEST(HostLink, ALongWriteWaitsForEachDelimiter) {
  const Device device = plc();
  std::string words;
  for (int i = 0; i < 70; ++i) words += "00A5";
  const Request request = device.write("DM100", words);
  const auto exchange = device.begin(request);
  const std::vector<Bytes> answers{{'\r'}, {'\r'}, framed("@00WD00")};
  const Outcome outcome = drive(*exchange, answers);
  ASSERT_TRUE(outcome.done()) << to_text(outcome);
  ASSERT_EQ(outcome.sent.size(), 3u);
  EXPECT_EQ(outcome.sent[0].size(), 128u);  // 29 words without `*`
  EXPECT_EQ(outcome.sent[1].size(), 127u);
  EXPECT_EQ(text(outcome.sent[2]).substr(0, 40), words.substr(0, 40));
  std::size_t sent = 0;
  for (const Bytes& each : outcome.sent) sent += each.size();
  EXPECT_EQ(device.protocol().size(request)->request_characters, sent);
  EXPECT_EQ(device.protocol().size(request)->rounds, 3u);
}

TEST(HostLink, AWriteThatThePlcAbortsFailsWithItsCode) {
  const Device device = plc();
  const auto aborted = [&](const std::string& answer) {
    const auto exchange = device.begin(device.write("DM100", std::string(4 * 70, '0')));
    return drive(*exchange, std::vector<Bytes>{{'\r'}, framed(answer)});
  };
  EXPECT_EQ(aborted("@00WDA3").cause, Cause::kChecksum);
  EXPECT_EQ(aborted("@00WDA3").code, 0xA3);
  EXPECT_EQ(aborted("@00WDA5").cause, Cause::kDeviceError);
  EXPECT_EQ(aborted("@00WDA5").code, 0xA5);
}

TEST(HostLink, AnInterruptedTransferIsClosedBeforeItFails) {
  const Device device = plc();
  const auto exchange = device.begin(device.read("DM0", 40));
  const std::vector<Bytes> answers{framed("@00RD00" + std::string(120, '0'), false)};
  const Outcome outcome = drive(*exchange, answers);
  EXPECT_FALSE(outcome.done());
  ASSERT_EQ(outcome.sent.size(), 3u);
  EXPECT_EQ(text(outcome.sent[1]), "\r");
  EXPECT_EQ(text(outcome.sent[2]), text(framed("@00XZ")));
}

TEST(HostLink, FramesOfOthersArePassedOver) {
  const Device device = plc(1);
  const auto exchange = device.begin(device.read("DM0"));
  Bytes stream = framed("@02RD001111");
  append(stream, framed("@01RR001111"));
  append(stream, framed("@01RD0011112222"));  // a response of another length
  append(stream, framed("@01RD00ABCD"));
  const Outcome outcome = drive(*exchange, stream);
  ASSERT_TRUE(outcome.done()) << to_text(outcome);
  EXPECT_EQ(to_hex(outcome.reply[0].items), "AB CD");
  const auto alone = device.begin(device.read("DM0"));
  EXPECT_EQ(drive(*alone, framed("@02RD001111")).cause, Cause::kForeign);
}

TEST(HostLink, TheMatrixHolds) {
  const Device device = plc();
  expect_matrix({.begin = [&] { return device.begin(device.read("DM150", 3)); },
                 .answers = {framed("@00RD00B005270F0000")}});
  expect_matrix({.begin = [&] { return device.begin(device.read("TF0", 3)); },
                 .answers = {framed("@00RG00101")}});
  expect_matrix({.begin = [&] { return device.begin(device.write("CIO100", "00F0")); },
                 .answers = {framed("@00WR00")}});
  expect_matrix(
      {.begin = [&] { return device.begin(device.read("DM0")); }, .answers = {framed("@00RD15")}});
  std::string words;
  for (int i = 0; i < 40; ++i)
    words +=
        to_hex(Bytes{static_cast<std::uint8_t>(7 * i), static_cast<std::uint8_t>(i * i)}, '\0');
  const MatrixCase long_read{
      .begin = [&] { return device.begin(device.read("DM0", 40)); },
      .answers = {framed("@00RD00" + words.substr(0, 120), false), framed(words.substr(120))}};
  expect_matrix(long_read);
  expect_random_bytes_are_refused(long_read, 3, 5000);
}

TEST(HostLinkAddress, NotationsAreUnderstood) {
  const Device c = plc();
  const Device fins("omron-hostlink", 0, {{"mode", "fins"}});
  expect_texts([&](std::string_view at) { return c.address(at); },
               {"DM100 -> DM:100/0", "D100 -> DM:100/0", "CIO12.03 -> CIO:12.3/1",
                "IR12 -> CIO:12/0", "HR10 -> HR:10/0", "E1_100 -> EM:32868/0", "T5 -> T:5/0",
                "TIM5 -> T:5/0", "CNT7 -> C:7/0", "TF5 -> TF:5/1"});
  expect_texts([&](std::string_view at) { return fins.address(at); },
               {"W5.07 -> W:5.7/1", "EMC_9 -> EM:393225/0"});
}

TEST(HostLinkAddress, FaultsSayWhatWasMeant) {
  const Device device = plc();
  for (const auto* at : {"", "DM", "X5", "DM10000", "W5", "CIO1.16", "CIO1.", "TF5.1", "E100",
                         "E1_32768", "E1_10000", "DM-1", "100"}) {
    (void)device.suggestion(at);
  }
  EXPECT_EQ(device.suggestion("dm5"), "DM5");
  EXPECT_EQ(device.suggestion("COI5"), "CIO5");
}

// Responses to commands that Fieldcast does not send are valid too.
TEST(HostLinkExplain, OtherCommandsResponsesAreNoFaults) {
  for (const auto* right : {"@00R#00CNT 1234", "@00R$00TIM 0001", "@00W#00", "@00RP00ABCD",
                            "@00WP00", "@00MI00", "@00ST", "@00QQMR00", "@00IC", "@00MS00A800"}) {
    const bool known = std::string_view(right) != "@00ST";
    EXPECT_EQ(has_fault(explain(framed(right))), !known) << right;
  }
}

}  // namespace
}  // namespace fieldcast::test
