// Tests declared text protocols: hexadecimal digits, LRC, end marks, named checksums.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/protocol/declared/word.hpp"
#include "tests/support/declared_device.hpp"
#include "tests/support/matrix.hpp"

namespace fieldcast::test {
namespace {

// Source: Modbus over Serial Line V1.02, 2.5.2.
constexpr std::string_view kModbusAscii = R"(
summary: registers by Modbus ASCII
addresses: { from: 1, to: 247 }
encoding: hex
areas: [{ name: holding }]
operations:
  - name: read
    read: holding
    command: 3
    count: 125
    request: &ask
      - { name: start, constant: ":" }
      - { is: address }
      - { is: command }
      - { is: first, bytes: 2 }
      - { is: count, bytes: 2 }
      - { is: checksum, kind: lrc, of: address..count, over: bytes }
      - { name: end, constant: "\r\n" }
    answer:
      - { name: start, constant: ":" }
      - { is: address }
      - { is: command }
      - { is: length, of: items }
      - { is: items }
      - { is: checksum, kind: lrc, of: address..items, over: bytes }
      - { name: end, constant: "\r\n" }
)";

Bytes ascii_answer(std::uint8_t unit, std::uint32_t registers, std::mt19937& random) {
  Bytes bytes{unit, 3, static_cast<std::uint8_t>(2 * registers)};
  for (std::uint32_t i = 0; i < 2 * registers; ++i)
    bytes.push_back(static_cast<std::uint8_t>(random()));
  std::uint8_t sum = 0;
  for (const auto byte : bytes) sum = static_cast<std::uint8_t>(sum + byte);
  bytes.push_back(static_cast<std::uint8_t>(0x100u - sum));
  const std::string text = ":" + to_hex(bytes, '\0') + "\r\n";
  return {text.begin(), text.end()};
}

TEST(DeclaredText, ModbusAsciiIsThatOfTheBuiltInOne) {
  const Device ours = declared_by(kModbusAscii, 9), theirs("modbus-ascii", 9);
  std::mt19937 random(11);
  for (int i = 0; i < 300; ++i) {
    const auto count = static_cast<std::uint32_t>(1 + random() % 125);
    const std::string at = "holding:" + std::to_string(random() % 65000);
    const Request request = ours.read(at, count), same = theirs.read(at, count);
    ASSERT_EQ(to_hex(ours.request_bytes(request)), to_hex(theirs.request_bytes(same)));
    EXPECT_EQ(ours.protocol().size(request)->response_characters,
              theirs.protocol().size(same)->response_characters);
    const Bytes answer = ascii_answer(9, count, random);
    const auto mine = drive(*ours.begin(request), answer),
               built_in = drive(*theirs.begin(same), answer);
    ASSERT_TRUE(mine.done() && built_in.done()) << to_text(mine) << ", " << to_text(built_in);
    EXPECT_EQ(mine.reply[0].items, built_in.reply[0].items);
  }
  const Request request = ours.read("holding:1", 3);
  expect_matrix(
      {.begin = [&] { return ours.begin(request); }, .answers = {ascii_answer(9, 3, random)}});
}

constexpr std::string_view kScale = R"(
summary: scales that answer in texts of their own length
addresses: { from: 0, to: 99 }
areas: [{ name: state, record: true }]
operations:
  - name: weigh
    read: state
    request:
      - { name: ask, constant: "W" }
      - { is: address, as: decimal, digits: 2 }
      - { name: end, constant: "\r" }
    answer:
      - { name: mark, constant: "w" }
      - { is: address, as: decimal, digits: 2 }
      - { name: weight, is: value, text: 8, variable: true }
      - { name: end, constant: "\r" }
)";

TEST(DeclaredText, ATextEndsAtItsMark) {
  const Device scale = declared_by(kScale, 4);
  const Request request = scale.read("weight", 4);
  const auto text = [](std::string_view characters) {
    return Bytes(characters.begin(), characters.end());
  };
  EXPECT_EQ(scale.request_bytes(request), text("W04\r"));
  for (const std::string_view weight : {"", "1", "12.5", "12345.67"}) {
    const auto outcome = drive(*scale.begin(request), text("w04" + std::string(weight) + "\r"));
    ASSERT_TRUE(outcome.done()) << weight;
    Bytes padded = text(weight);
    padded.resize(8);
    EXPECT_EQ(outcome.reply[0].items, padded) << weight;
  }
  EXPECT_FALSE(drive(*scale.begin(request), text("w04123456789\r")).done());
  EXPECT_FALSE(drive(*scale.begin(request), text("w0512.5\r")).done());
  EXPECT_EQ(drive(*scale.begin(request), text("w0412")).cause, Cause::kTruncated);
}

// Vaisala PTU300 in POLL mode, user's guide M210796EN: the text and its end mark begin alike.
constexpr std::string_view kWeather = R"(
summary: weather transmitters
addresses: { from: 1, to: 1 }
areas: [{ name: state, record: true }]
operations:
  - name: send
    read: state
    request: [{ name: ask, constant: "SEND\r" }]
    answer:
      - { name: p, constant: "P=" }
      - { name: pressure, is: value, text: decimal(10), variable: true }
      - { name: t, constant: " hPa T=" }
      - { name: temperature, is: value, text: decimal(10), variable: true }
      - { name: end, constant: " 'C\r\n" }
)";

TEST(DeclaredText, ATextEndsAtTheWholeMark) {
  const Device device = declared_by(kWeather, 1);
  const Request request = device.read("pressure", 10);
  const auto text = [](std::string_view characters) {
    return Bytes(characters.begin(), characters.end());
  };
  const Bytes frame = text("P=  1013.00 hPa T=  22.98 'C\r\n");
  const Outcome outcome = drive(*device.begin(request), frame);
  ASSERT_TRUE(outcome.done()) << to_text(outcome);
  EXPECT_EQ(to_hex(ByteView(outcome.reply[0].items).first(9)), to_hex(text("  1013.00")));
  expect_matrix(
      {.begin = [&] { return device.begin(request); }, .answers = {frame}, .checked = false});
  EXPECT_FALSE(drive(*device.begin(request), text("P=12345678901 hPa T=1 'C\r\n")).done());
  EXPECT_FALSE(drive(*device.begin(request), text("P=1 hPa  T=1 'C\r\n")).done());
  const auto fields =
      declared::explain(*config::load_declaration_text(kWeather, "t")->value, frame);
  EXPECT_TRUE(std::ranges::any_of(fields, [](const FrameField& field) {
    return field.name == "temperature" && field.value == "  22.98";
  }));
}

TEST(DeclaredText, AResponseWithTheBytesOfItsRequestIsKnownBeforehand) {
  const auto ambiguous = [](const std::string& end_of_response) {
    return declared_by(R"(
summary: registers
addresses: { from: 1, to: 9 }
areas: [{ name: r, items: 100 }]
operations:
  - name: read
    read: r
    request: [{ is: address }, { name: ask, constant: 3 }, { is: first }]
    answer: [{ is: address }, { name: ask, constant: 3 }, { is: first }, { is: items }]
  - name: set
    write: r
    request: [{ is: address }, { name: ask, constant: 6 }, { is: first }, { is: items },
              { name: end, constant: 0 }]
    answer: [{ is: address }, { name: did, constant: 6 }, { is: first }, { is: items }, )" +
                           end_of_response + "]\n",
                       1)
        .protocol()
        .traits()
        .echo_is_ambiguous;
  };
  EXPECT_TRUE(ambiguous("{ name: end, constant: 0 }"));
  EXPECT_TRUE(ambiguous("{ name: state, is: error }")) << "no error is 0";
  EXPECT_TRUE(ambiguous("{ name: state, is: unused }"));
  EXPECT_FALSE(ambiguous("{ name: end, constant: 1 }"));
  EXPECT_FALSE(ambiguous("{ name: end, constant: 0, bytes: 2 }"));
}

// Pfeiffer Vacuum protocol: the sum in three decimal digits (py-pfeiffer-vacuum-protocol,
// test_parser.py). VE.Direct: all bytes and the checksum add up to 0x55.
TEST(DeclaredText, ASumMayBeDecimalAndMayBeginAboveZero) {
  const Device gauge = declared_by(R"(
summary: gauges
addresses: { from: 1, to: 255 }
areas: [{ name: state, record: true }]
operations:
  - name: read
    read: state
    request: [{ is: address, as: decimal, digits: 3 }, { name: ask, constant: "0034902=?" },
              { is: checksum, kind: sum, of: address..ask, as: decimal, digits: 3 },
              { name: end, constant: "\r" }]
    answer: [{ is: address, as: decimal, digits: 3 }, { name: tell, constant: "1034906" },
             { name: name, is: value, text: 6 },
             { is: checksum, kind: sum, of: address..name, as: decimal, digits: 3 },
             { name: end, constant: "\r" }]
)",
                                   1);
  const auto text = [](std::string_view characters) {
    return Bytes(characters.begin(), characters.end());
  };
  const Request request = gauge.read("name", 3);
  EXPECT_EQ(gauge.request_bytes(request), text("0010034902=?111\r"));
  EXPECT_TRUE(drive(*gauge.begin(request), text("0011034906MPT200123\r")).done());
  EXPECT_EQ(drive(*gauge.begin(request), text("0011034906MPT200379\r")).cause, Cause::kChecksum);
  const declared::Check check{.complement = declared::Complement::kTwos, .start = 0xAB};
  EXPECT_EQ(check_of(check, 8, Bytes{7, 0xF0, 0xED, 0}), 0x71u);
}

TEST(DeclaredText, AnExplanationShowsTheAddressOfTheDevice) {
  const auto loaded = config::load_declaration_text(R"(
summary: controllers
addresses: { from: 0, to: 31 }
areas: [{ name: state, record: true }]
operations:
  - name: read
    read: state
    request: [{ name: stx, constant: [0x02] }, { is: address, plus: 0x80 },
              { name: end, constant: "?" }]
    answer: [{ name: stx, constant: [0x02] }, { is: address, plus: 0x80 },
             { name: rest, is: unused, text: 2 }, { name: level, is: value }]
)",
                                                    "test.yaml");
  ASSERT_TRUE(loaded) << config::to_text(std::span(loaded.error()));
  const auto fields = declared::explain(*loaded->value, from_hex("02 83 0F D2 07").value());
  const auto shows = [&](std::string_view name, std::string_view value) {
    return std::ranges::any_of(fields, [&](const FrameField& field) {
      return field.name == name && field.value == value;
    });
  };
  EXPECT_TRUE(shows("address", "3"));
  EXPECT_TRUE(shows("rest", "0F D2"));
}

constexpr std::string_view kGauge = R"(
summary: gauges that may echo a space and may end with a line feed
addresses: { from: 1, to: 1 }
areas: [{ name: state, record: true }]
operations:
  - name: measure
    read: state
    request: [{ name: ask, constant: "M\r" }]
    answer:
      - { name: begin, constant: "m" }
      - { name: space, constant: " ", optional: true }
      - { name: level, is: value, text: 4 }
      - { name: end, constant: "\r" }
      - { name: feed, constant: "\n", optional: true }
)";

TEST(DeclaredText, AnOptionalConstantMayBeMissing) {
  const Device gauge = declared_by(kGauge, 1);
  const Request request = gauge.read("level", 2);
  for (const std::string_view text : {"m 12.5\r\n", "m12.5\r\n", "m 12.5\r", "m12.5\r"}) {
    const Outcome outcome = drive(*gauge.begin(request), Bytes(text.begin(), text.end()));
    ASSERT_TRUE(outcome.done()) << text;
    EXPECT_EQ(to_hex(outcome.reply[0].items), "31 32 2E 35") << text;
  }
  const std::string_view cut = "m 12.5";
  EXPECT_EQ(drive(*gauge.begin(request), Bytes(cut.begin(), cut.end())).cause, Cause::kTruncated);
}

// Digits of a checksum are between the text and the constant that ends the frame.
constexpr std::string_view kSummed = R"(
summary: transmitters
addresses: { from: 1, to: 9 }
areas: [{ name: state, record: true }]
operations:
  - name: read
    read: state
    request: [{ name: ask, constant: "#" }, { is: address }]
    answer:
      - { name: begin, constant: ">" }
      - { name: level, is: value, text: decimal(8), variable: true }
      - { is: checksum, kind: sum, of: begin..level, as: hex, digits: 2 }
      - { name: end, constant: "\r" }
)";

TEST(DeclaredText, ATextMayEndBeforeDigits) {
  const Device device = declared_by(kSummed, 1);
  const Request request = device.read("level", 4);
  const auto text = [](std::string_view characters) {
    return Bytes(characters.begin(), characters.end());
  };
  const Outcome outcome = drive(*device.begin(request), text(">+7.21162\r"));
  ASSERT_TRUE(outcome.done()) << to_text(outcome);
  EXPECT_EQ(to_hex(outcome.reply[0].items), "2B 37 2E 32 31 31 00 00");
  EXPECT_TRUE(drive(*device.begin(request), text(">3E\r")).done()) << "an empty text";
  EXPECT_FALSE(drive(*device.begin(request), text(">+1234567862\r")).done());
  expect_matrix({.begin = [&] { return device.begin(request); },
                 .answers = {text(">+7.21162\r")},
                 .checked = true});
  const auto fields =
      declared::explain(*config::load_declaration_text(kSummed, "t")->value, text(">+7.21162\r"));
  EXPECT_TRUE(std::ranges::any_of(fields, [](const FrameField& field) {
    return field.name == "level" && field.value == "+7.211" && field.fault.empty();
  }));
}

constexpr std::string_view kDrive = R"(
summary: drives with names
addresses: { text: 4 }
escape: dle
areas: [{ name: word, items: 256 }]
operations:
  - name: read
    read: word
    count: 3
    request:
      - { name: begin, constant: [0x10, 0x02] }
      - { is: address, text: 4 }
      - { name: colon, constant: ":" }
      - { is: first }
      - { is: count }
      - { name: end, constant: [0x10, 0x03] }
      - { is: checksum, kind: crc-8/maxim-dow, of: address..count }
    answer:
      - { name: begin, constant: [0x10, 0x02] }
      - { is: address, text: 4 }
      - { name: colon, constant: ":" }
      - { is: length, of: items, counts: items }
      - { is: items, add: 1, xor: 0xFF }
      - { name: end, constant: [0x10, 0x03] }
      - { is: checksum, kind: sum, of: address..items, over: bytes }
)";

// Constructed by the rules of the declaration.
TEST(DeclaredText, AnAddressIsTextAndFramesAreEscaped) {
  const auto loaded = config::load_declaration_text(kDrive, "test.yaml");
  ASSERT_TRUE(loaded) << config::to_text(std::span(loaded.error()));
  const auto drive_named = [&](const std::string& name) {
    return Device(std::move(*declared::make(loaded->value, {.long_address = name})));
  };
  const Device device = drive_named("M1");
  const Request request = device.read("word:16", 2);
  const Bytes sent = device.request_bytes(request);
  const Bytes covered{0x4D, 0x31, 0x3A, 0x10, 0x02};
  const declared::Crc crc{8, 0x31, 0, 0, true, true};
  EXPECT_EQ(to_hex(sent), "10 02 4D 31 3A 10 10 02 10 03 " +
                              to_hex(Bytes{static_cast<std::uint8_t>(crc_of(crc, covered))}));
  // Items EE10 and 0001: bytes + 1, inverted: 10 EE, FE FD; 10 is sent twice.
  Bytes response = from_hex("10 02 4D 31 3A 02 10 10 EE FE FD 10 03").value();
  response.push_back(static_cast<std::uint8_t>(0x4D + 0x31 + 0x3A + 0x02 + 0xEE + 0x10 + 0x01));
  const Outcome outcome = drive(*device.begin(request), response);
  ASSERT_TRUE(outcome.done()) << to_text(outcome);
  EXPECT_EQ(to_hex(outcome.reply[0].items), "EE 10 00 01");
  expect_matrix({.begin = [&] { return device.begin(request); }, .answers = {response}});
  const Device other = drive_named("M2");
  EXPECT_EQ(drive(*other.begin(request), response).cause, Cause::kForeign);
  EXPECT_FALSE(declared::make(loaded->value, {.long_address = "M1234"}));
  const auto fields = declared::explain(*loaded->value, response);
  EXPECT_TRUE(std::ranges::any_of(fields, [](const FrameField& field) {
    return field.name == "address" && field.value == "M1" && field.fault.empty();
  }));
}

// No byte of a frame reaches a terminal or a JSON line unescaped.
TEST(DeclaredText, IsExplainedInPrintableUtf8) {
  const auto loaded = config::load_declaration_text(kScale, "test.yaml");
  ASSERT_TRUE(loaded);
  const std::string frame = "w04\xE4\x1B[2J\r";
  const auto fields = declared::explain(*loaded->value, Bytes(frame.begin(), frame.end()));
  EXPECT_TRUE(std::ranges::any_of(
      fields, [](const FrameField& field) { return field.value == "\\xE4\\x1B[2J"; }));
}

TEST(DeclaredCheck, SumsAndTheirComplements) {
  using namespace declared;
  const Bytes bytes{0xF0, 0x3C, 0x81};
  EXPECT_EQ(check_of({.kind = CheckKind::kSum}, 8, bytes), 0xADu);
  EXPECT_EQ(check_of({.kind = CheckKind::kSum}, 16, bytes), 0x1ADu);
  EXPECT_EQ(check_of({.kind = CheckKind::kXor}, 8, bytes), 0x4Du);
  EXPECT_EQ(check_of({.kind = CheckKind::kAnd}, 8, bytes), 0x00u);
  EXPECT_EQ(check_of({.kind = CheckKind::kAnd}, 8, ByteView(bytes).first(2)), 0x30u);
  EXPECT_EQ(check_of({.kind = CheckKind::kSum, .complement = Complement::kTwos}, 8, bytes), 0x53u);
  EXPECT_EQ(check_of({.kind = CheckKind::kSum, .complement = Complement::kOnes}, 8, bytes), 0x52u);
}

}  // namespace
}  // namespace fieldcast::test
