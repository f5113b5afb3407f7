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

Device plc(std::map<std::string, std::string> options = {}) {
  return {"mitsubishi-fx", 0, options};
}
std::string text(ByteView bytes) { return {bytes.begin(), bytes.end()}; }
Bytes framed(const std::string& body) {
  Bytes frame;
  frame.push_back(0x02);
  for (const char c : body) frame.push_back(static_cast<std::uint8_t>(c));
  frame.push_back(0x03);
  append_digits(frame, sum8(ByteView(frame).subspan(1)), 2);
  return frame;
}
bool has_fault(const std::vector<FrameField>& fields) {
  return std::any_of(fields.begin(), fields.end(),
                     [](const FrameField& field) { return !field.fault.empty(); });
}
std::vector<FrameField> explain(const Bytes& frame) {
  return find_protocol("mitsubishi-fx")->explain(frame);
}
unsigned number(const std::string& digits) {
  return static_cast<unsigned>(std::stoul(digits, nullptr, 16));
}

std::string octal(unsigned value) {
  std::string digits;
  do digits.insert(digits.begin(), static_cast<char>('0' + value % 8));
  while ((value /= 8) != 0);
  return digits;
}

// The device at a byte address of the classic map, and the items in this many bytes.
struct Placed {
  std::string at;
  unsigned count;
};
std::optional<Placed> placed(unsigned address, unsigned bytes) {
  const auto bits = [&](const std::string& name, unsigned base, unsigned first = 0) {
    return Placed{name + std::to_string(first + 8 * (address - base)), 8 * bytes};
  };
  if (address >= 0x1000) return Placed{"D" + std::to_string((address - 0x1000) / 2), bytes / 2};
  if (address >= 0x0E00)
    return Placed{"D" + std::to_string(8000 + (address - 0x0E00) / 2), bytes / 2};
  if (address >= 0x0C00)
    return Placed{"C" + std::to_string(200 + (address - 0x0C00) / 4), bytes / 4};
  if (address >= 0x0A00) return Placed{"C" + std::to_string((address - 0x0A00) / 2), bytes / 2};
  if (address >= 0x01E0 && address < 0x0200) return bits("M", 0x01E0, 8000);
  if (address >= 0x01C0 && address < 0x01E0) return bits("CS", 0x01C0);
  if (address >= 0x0100 && address < 0x01C0) return bits("M", 0x0100);
  if (address >= 0x00A0 && address < 0x00C0)
    return Placed{"Y" + octal(8 * (address - 0x00A0)), 8 * bytes};
  if (address >= 0x0080 && address < 0x00A0)
    return Placed{"X" + octal(8 * (address - 0x0080)), 8 * bytes};
  if (address < 0x0080) return bits("S", 0);
  return std::nullopt;
}

std::string forced(unsigned address) {
  if (address >= 0x0F00) return "M" + std::to_string(8000 + address - 0x0F00);
  if (address >= 0x0800) return "M" + std::to_string(address - 0x0800);
  if (address >= 0x0500) return "Y" + octal(address - 0x0500);
  return "S" + std::to_string(address);
}

std::string reversed_pairs(const std::string& digits, std::size_t each) {
  std::string result;
  for (std::size_t at = 0; at < digits.size(); at += 2 * each) {
    for (std::size_t i = each; i-- > 0;) result += digits.substr(at + 2 * i, 2);
  }
  return result;
}

// Parses a published classic request without the codec.
std::optional<Request> meant(const Device& device, const std::string& q) {
  if (q.size() < 9 || q[0] != 0x02) return std::nullopt;
  if (q[1] == '0' && q.size() == 11) {
    const auto at = placed(number(q.substr(2, 4)), number(q.substr(6, 2)));
    if (!at) return std::nullopt;
    return device.read(at->at, at->count);
  }
  if (q[1] == '1') {
    const auto at = placed(number(q.substr(2, 4)), number(q.substr(6, 2)));
    const std::size_t bytes = number(q.substr(6, 2));
    return device.write(at->at, reversed_pairs(q.substr(8, q.size() - 11), bytes / at->count));
  }
  if ((q[1] == '7' || q[1] == '8') && q.size() == 9) {
    return device.write(forced(number(q.substr(4, 2)) * 256 + number(q.substr(2, 2))),
                        q[1] == '7' ? "01" : "00");
  }
  return std::nullopt;
}

TEST(FxVectors, OurRequestsAreTheirsAndTheirResponsesAreRead) {
  int seen = 0;
  for (const GoldenVector& vector : load_vectors("fx")) {
    if (vector.kind != "ok") continue;
    SCOPED_TRACE(vector.name);
    const Device device = plc();
    const auto request = meant(device, text(vector.request));
    if (!request) continue;
    if (device.protocol().size(*request) == std::nullopt) continue;
    ++seen;
    EXPECT_EQ(to_hex(device.request_bytes(*request)), to_hex(vector.request));
    const auto exchange = device.begin(*request);
    const Outcome outcome = drive(*exchange, vector.response);
    ASSERT_TRUE(outcome.done()) << to_text(outcome);
    const auto* read = std::get_if<ReadRequest>(&*request);
    expect_matrix({.begin = [&] { return device.begin(*request); },
                   .answers = {vector.response},
                   .noise_recovers = read != nullptr});
    if (read == nullptr) continue;
    const std::string data = text(vector.response).substr(1, vector.response.size() - 4);
    const unsigned item_bits = device.protocol().areas()[read->ranges[0].area].item_bits;
    if (item_bits == 1) {
      for (std::size_t i = 0; i < outcome.reply[0].items.size(); ++i) {
        EXPECT_EQ(outcome.reply[0].items[i], number(data.substr(i / 8 * 2, 2)) >> i % 8 & 1) << i;
      }
    } else {
      EXPECT_EQ(to_hex(outcome.reply[0].items, '\0'), reversed_pairs(data, item_bits / 8));
    }
  }
  EXPECT_GE(seen, 18);
}

TEST(FxVectors, TheExtendedForceIsTheirs) {
  const Device device = plc({{"commands", "extended"}});
  for (const GoldenVector& vector : load_vectors("fx")) {
    if (!vector.name.starts_with("fx3u_m0_")) continue;
    EXPECT_EQ(
        to_hex(device.request_bytes(device.write("M0", vector.name == "fx3u_m0_on" ? "01" : "00"))),
        to_hex(vector.request));
  }
}

TEST(FxVectors, ExplanationsFindTheFaults) {
  for (const GoldenVector& vector : load_vectors("fx")) {
    SCOPED_TRACE(vector.name);
    for (const Bytes& each : {vector.request, vector.response}) {
      if (each.empty() || vector.expect == "wrong_address") continue;
      EXPECT_EQ(has_fault(explain(each)), vector.kind == "malformed") << to_hex(each);
    }
  }
}

TEST(FxExplain, TransferCompleteIsARightRequest) {
  const auto fields = explain(*from_hex("02 42 03 34 35"));
  EXPECT_FALSE(has_fault(fields));
  EXPECT_EQ(fields.at(1).value, "B transfer complete");
  EXPECT_TRUE(has_fault(explain(*from_hex("02 42 03 34 36"))));
}

TEST(FxExchange, MalformedResponsesHaveNoValue) {
  for (const GoldenVector& vector : load_vectors("fx")) {
    if (vector.kind != "malformed" || vector.response.empty()) continue;
    SCOPED_TRACE(vector.name);
    const Device device = plc();
    const auto exchange = device.begin(device.read("D0"));
    const Outcome outcome = drive(*exchange, vector.response);
    EXPECT_FALSE(outcome.done());
    EXPECT_EQ(outcome.cause, vector.expect == "sum_error" ? Cause::kChecksum : Cause::kTruncated);
  }
}

TEST(FxExchange, ARefusalIsTheDevicesErrorWhenItIsRepeated) {
  const Device device = plc();
  for (const Request& request :
       {device.write("D0", "0001"), device.write("M0", "01"), device.read("D0")}) {
    const auto exchange = device.begin(request);
    const Outcome outcome = drive(*exchange, std::vector<Bytes>{{0x15}, {0x15}});
    EXPECT_EQ(outcome.cause, Cause::kDeviceError);
    EXPECT_EQ(outcome.code, 0x15);
    ASSERT_EQ(outcome.sent.size(), 2u);
    EXPECT_EQ(outcome.sent[0], outcome.sent[1]);
  }
}

TEST(FxExchange, ARequestThatTheLineGarbledIsSentAgain) {
  const Device device = plc();
  const auto read = device.begin(device.read("D0"));
  const Outcome outcome = drive(*read, std::vector<Bytes>{{0x15}, framed("3412")});
  ASSERT_TRUE(outcome.done()) << to_text(outcome);
  EXPECT_EQ(to_hex(outcome.reply[0].items), "12 34");
  EXPECT_TRUE(
      drive(*device.begin(device.write("D0", "0001")), std::vector<Bytes>{{0x15}, {0x06}}).done());
}

// The response to the repeated request may still arrive, so it is pending.
TEST(FxExchange, SilenceBehindARefusalIsNotARefusal) {
  const Device device = plc();
  for (const Request& request : {device.write("D0", "0001"), device.read("D0")}) {
    const auto exchange = device.begin(request);
    EXPECT_EQ(drive(*exchange, std::vector<Bytes>{{0x15}, {}}).cause, Cause::kNoResponse);
  }
}

TEST(FxExchange, AnAcknowledgementBehindOtherCharactersIsNone) {
  const Device device = plc();
  const auto exchange = device.begin(device.write("D0", "0001"));
  EXPECT_EQ(drive(*exchange, Bytes{0x33, 0x06}).cause, Cause::kMalformed);
  const auto turned = device.begin(device.write("D0", "0001"));
  EXPECT_TRUE(drive(*turned, Bytes{0x00, 0x06}).done());
}

TEST(FxExchange, SizesAreExact) {
  for (const auto* commands : {"classic", "extended"}) {
    const Device device = plc({{"commands", commands}});
    for (const Request& request : {device.read("D10", 5), device.read("M3", 10),
                                   device.write("D1", "00010002"), device.write("Y7", "01")}) {
      const auto size = device.protocol().size(request);
      ASSERT_TRUE(size.has_value());
      EXPECT_EQ(size->request_characters, device.request_bytes(request).size());
      Bytes out;
      EXPECT_EQ(device.begin(request)->start(out).characters, size->response_characters);
    }
    EXPECT_TRUE(device.protocol().size(device.read("D0", 32)).has_value());
    EXPECT_FALSE(device.protocol().size(device.read("D0", 33)).has_value());
    EXPECT_FALSE(device.protocol().size(device.read("M1", 512)).has_value());  // 65 bytes
    EXPECT_FALSE(device.protocol().size(device.write("X0", "01")).has_value());
    EXPECT_FALSE(device.protocol().size(device.write("M0", "0101")).has_value());
  }
}

TEST(FxExchange, BitsAreCutOutOfWholeBytes) {
  const Device device = plc();
  const auto exchange =
      device.begin(device.read("M14", 4));  // M14, M15 of byte 0101; M16, M17 of byte 0102
  const Outcome outcome = drive(*exchange, framed("4002"));
  ASSERT_TRUE(outcome.done()) << to_text(outcome);
  EXPECT_EQ(to_hex(outcome.reply[0].items), "01 00 00 01");
}

TEST(FxExchange, TheMatrixHolds) {
  const Device device = plc();
  const MatrixCase read{.begin = [&] { return device.begin(device.read("D123", 2)); },
                        .answers = {framed("0C000000")}};
  expect_matrix(read);
  // Random bytes can match a sum of eight bits, so this only checks that nothing crashes.
  expect_random_bytes_are_refused(
      {.begin = read.begin, .answers = {framed("3412ABCD")}, .checked = false}, 11, 5000);
  expect_matrix({.begin = [&] { return device.begin(device.write("M17", "01")); },
                 .answers = {{0x06}},
                 .noise_recovers = false});
}

TEST(FxAddress, NotationsAreUnderstood) {
  const Device device = plc();
  const auto name = [&](std::string_view at) { return device.address(at); };
  expect_texts(
      name, {"D100 -> D:100/0", "D100.3 -> D:100.3/1", "D8010 -> D8000:10/0", "X17 -> X:15/1",
             "Y10 -> Y:8/1", "M8001 -> M8000:1/1", "T5 -> T:5/0", "TN5 -> T:5/0", "TS5 -> TS:5/1",
             "C5 -> C:5/0", "C200 -> C200:0/32", "S999 -> S:999/1"});
}

TEST(FxAddress, FaultsSayWhatIsWrong) {
  const Device device = plc();
  for (const auto* at : {"", "D", "D8256", "D9000", "X8", "X400", "Y18", "M1536", "Q1", "D1.16",
                         "M1.0", "D-1", "C256"}) {
    (void)device.suggestion(at);
  }
  EXPECT_EQ(device.suggestion("d5"), "D5");
  EXPECT_FALSE(plc({{"commands", "extended"}}).protocol().parse_address("TS5").has_value());
}

}  // namespace
}  // namespace fieldcast::test
