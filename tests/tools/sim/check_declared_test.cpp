// Tests the whole matrix of declarations that use what few shipped ones do.
#include "tests/support/multimeter.hpp"
#include "tests/tools/sim/check_support.hpp"

namespace fieldcast::sim {
namespace {

TEST(SimCheck, EachFormOfAResponseIsTried) {
  const auto declaration = config::load_declaration_text(test::kMultimeter, "meter.yaml");
  ASSERT_TRUE(declaration);
  const auto subjects = subjects_of(*declaration);
  ASSERT_EQ(subjects.size(), 2u);
  EXPECT_EQ(subjects[1].variant, "form 2");
  expect_all_pass(subjects);
  const auto area = AreaIndex{0};
  EXPECT_EQ(Requests(subjects[0]).places(area).size(), 2u);
  EXPECT_EQ(Requests(subjects[1]).places(area)[1].range.count, 2u) << "amperes";
}

// A frame of three bytes with a check of one: noise contains it by chance.
TEST(SimCheck, AFrameInTheNoiseIsNoFault) {
  const Subject subject = declared_as(R"(
summary: meters
addresses: { from: 1, to: 1 }
areas: [{ name: state, record: true }]
operations:
  - name: read
    read: state
    request: [{ name: ask, constant: "R" }]
    answer: [{ name: level, is: value, bytes: 2 }, { is: checksum, kind: sum, of: level }]
)");
  CheckRows rows;
  check_responses(subject, rows);
  const auto noise = std::ranges::find(rows, "noise before", &CheckRow::check);
  ASSERT_NE(noise, rows.end());
  EXPECT_EQ(noise->failed(), 0u) << failures(rows);
  EXPECT_NE(noise->note.find("contain a valid frame"), std::string::npos) << noise->note;
}

// A record of two texts, one of odd length and one that ends at a constant; one address.
constexpr const char* kTexts = R"(summary: A scale that says two texts
addresses: { from: 1, to: 1 }
areas:
  - { name: state, record: true }
operations:
  - name: read
    read: state
    request: [ { name: header, constant: 0x05 }, { is: address } ]
    answer:
      - { name: header, constant: 0x02 }
      - { is: address }
      - { name: title, is: value, text: 7 }
      - { name: lot, is: value, text: 9, variable: true }
      - { name: end, constant: "Q" }
      - { is: checksum, kind: sum, of: header..end }
)";

TEST(SimCheck, TextsOfOddLengthARecordWithoutANumberAndOneAddressAreNoFault) {
  expect_all_pass({declared_as(kTexts)});
}

// A writable text, without a frame for a refusal of the device.
constexpr const char* kWrittenText = R"(summary: A scale whose limit is a text
addresses: { from: 1, to: 9 }
areas:
  - { name: state, record: true }
operations:
  - name: read
    read: state
    request: [ { name: header, constant: 0x05 }, { is: address } ]
    answer: &state
      - { name: header, constant: 0x02 }
      - { is: address }
      - { name: limit, is: value, text: 8 }
      - { is: checksum, kind: sum, of: header..limit }
  - name: set the limit
    write: state
    request:
      - { name: header, constant: 0x06 }
      - { is: address }
      - { name: limit, is: value, text: 8 }
    answer: *state
)";

TEST(SimCheck, ATextThatTheDeviceRefusesIsNotWritten) {
  expect_all_pass({declared_as(kWrittenText)});
}

constexpr const char* kNumbers = R"(summary: A meter with numbers of all kinds
addresses: { from: 1, to: 9 }
areas:
  - { name: state, record: true }
operations:
  - name: read
    read: state
    request: [ { name: header, constant: 0x05 }, { is: address } ]
    answer:
      - { name: header, constant: 0x02 }
      - { is: address }
      - { name: small, is: value, signed: true }
      - { name: count, is: value, as: decimal, digits: 3 }
      - { name: total, is: value, bytes: 4, signed: true }
      - { is: checksum, kind: sum, of: header..total }
)";

TEST(SimCheck, NumbersWithASignOrInDigitsAreNoFault) { expect_all_pass({declared_as(kNumbers)}); }

constexpr const char* kScaled =
    R"(summary: A counter whose values have decimals, exponents and signs
addresses: { from: 1, to: 99 }
areas:
  - { name: state, record: true }
operations:
  - name: read
    read: state
    request: [{ name: ask, constant: "R" }, { is: address }]
    answer: &state
      - { name: begin, constant: "r" }
      - { is: address }
      - { name: weight, is: value, bytes: 3 }
      - { name: tare, is: value, bytes: 3 }
      - { name: point, is: decimals, of: weight..tare, bits: 3, plus: 2 }
      - { is: unused, bits: 4 }
      - { name: minus, is: sign, of: weight, bits: 1 }
      - { name: limit, is: value, bytes: 2, signed: true }
      - { name: limit-power, is: exponent, of: limit, signed: true }
      - { name: count, is: value, text: decimal(6) }
      - { name: count-sign, is: sign, of: count, on: 0x2D, off: 0x2B }
      - { name: count-point, is: decimals, of: count, as: decimal, digits: 1 }
      - { name: total, is: value, as: bcd, bytes: 3 }
      - { name: total-power, is: exponent, of: total, plus: 128 }
      - { is: checksum, kind: sum, of: begin..total-power }
  - name: set the limit
    write: state
    request:
      - { name: ask, constant: "L" }
      - { is: address }
      - { name: limit, is: value, bytes: 2, signed: true }
      - { name: limit-power, is: exponent, of: limit, signed: true }
      - { is: checksum, kind: sum, of: ask..limit-power }
    answer: *state
  - name: set the count
    write: state
    request:
      - { name: ask, constant: "C" }
      - { is: address }
      - { name: count-point, is: decimals, of: count, as: decimal, digits: 1 }
      - { name: count-sign, is: sign, of: count, on: 0x2D, off: 0x2B }
      - { name: count, is: value, text: decimal(6) }
      - { is: checksum, kind: sum, of: ask..count }
    answer: *state
)";

TEST(SimCheck, ScaledValuesAreReadAndWritten) {
  const Subject subject = declared_as(kScaled);
  expect_all_pass({subject});
  CheckRows rows;
  check_values(subject, rows);
  EXPECT_EQ(rows[1].passed, 16u) << "limit and count are written";
}

constexpr const char* kAreas = R"(summary: A controller with bytes and words
addresses: { from: 1, to: 9 }
areas:
  - { name: byte, item: byte, items: 256, prefix: "B", base: hexadecimal }
  - { name: word, item: 16bit, items: 4096, prefix: "W", base: hexadecimal, origin: 10 }
operations:
  - name: read bytes
    read: byte
    count: 16
    command: 1
    request:
      - { name: header, constant: 0x05 }
      - { is: address }
      - { is: command }
      - { is: first }
      - { is: count }
      - { is: checksum, kind: sum, of: header..count }
    answer:
      - { name: header, constant: 0x02 }
      - { is: address }
      - { is: items }
      - { is: checksum, kind: sum, of: header..items }
  - name: read words
    read: word
    count: 16
    command: 2
    request:
      - { name: header, constant: 0x05 }
      - { is: address }
      - { is: command }
      - { is: first, bytes: 2 }
      - { is: count }
      - { is: checksum, kind: sum, of: header..count }
    answer:
      - { name: header, constant: 0x03 }
      - { is: address }
      - { is: items }
      - { is: checksum, kind: sum, of: header..items }
)";

TEST(SimCheck, HexadecimalNumbersInEitherCaseAreAddresses) {
  expect_all_pass({declared_as(kAreas)});
}

// Text addresses, transformed and escaped bytes, a length in items, a CRC by its parameters.
std::string drive_text(const std::string& escape, const std::string& begin) {
  const std::string open =
      begin.empty() ? "" : "      - { name: begin, constant: [" + begin + "] }\n";
  const std::string end = escape == "dle"    ? "[0x10, 0x03]"
                          : escape == "slip" ? "0xC0"
                          : escape == "cobs" ? "0"
                          : escape == "kmp"  ? "0x0D"
                                             : "0x7E";
  const std::string crc =
      "kind: { width: 24, polynomial: 0x864CFB, start: 0xB704CE }, bytes: 3, over: bytes";
  return "summary: drives\naddresses: { text: 4 }\nescape: " + escape +
         "\nareas: [{ name: word }, { name: stop, trigger: true }]\noperations:\n"
         "  - name: read\n    read: word\n    command: 0x10\n    count: 9\n    request:\n" +
         open +
         "      - { is: address, text: 4 }\n      - { name: colon, constant: \":\" }\n"
         "      - { is: command }\n      - { is: first, bytes: 2 }\n      - { is: count }\n"
         "      - { is: checksum, of: address..count, " +
         crc + " }\n      - { name: end, constant: " + end + " }\n    answer:\n" + open +
         "      - { is: address, text: 4 }\n      - { name: colon, constant: \":\" }\n"
         "      - { is: command }\n      - { is: first, bytes: 2 }\n"
         "      - { is: length, of: items, counts: items }\n      - { is: items, add: 7, xor: 0x55 "
         "}\n"
         "      - { is: checksum, of: address..items, " +
         crc + " }\n      - { name: end, constant: " + end +
         " }\n  - name: stop\n    write: stop\n    command: 0xC0\n    request: &stop\n" + open +
         "      - { is: address, text: 4 }\n      - { name: colon, constant: \":\" }\n"
         "      - { is: command }\n      - { is: checksum, of: address..command, " +
         crc + " }\n      - { name: end, constant: " + end + " }\n    answer: *stop\n";
}

TEST(SimCheck, PassesWithEscapedFramesAndTextAddresses) {
  for (const auto& [escape, begin] : {std::pair<std::string, std::string>{"dle", "0x10, 0x02"},
                                      {"slip", "0xC0"},
                                      {"cobs", ""},
                                      {"hdlc", "0x7E"},
                                      {"shdlc", "0x7E"},
                                      {"kmp", "0x80"}}) {
    SCOPED_TRACE(escape);
    const auto declaration =
        config::load_declaration_text(drive_text(escape, begin), "drives.yaml");
    ASSERT_TRUE(declaration) << config::to_text(std::span(declaration.error()));
    expect_all_pass(subjects_of(*declaration));
  }
}

// A command, or constants that differ between the operations, behind an address that is text.
TEST(SimCheck, PassesWithAnythingBehindATextAddress) {
  const auto declaration = config::load_declaration_text(R"(
summary: controllers
addresses: { text: 4 }
areas: [{ name: state, record: true }, { name: level, record: true }]
operations:
  - name: state
    read: state
    command: 0x50
    request: [{ is: address, text: 4 }, { is: command }, { name: end, constant: "\r" }]
    answer: [{ is: address, text: 4 }, { name: is, constant: " " },
             { name: flags, is: value, bytes: 2 }]
  - name: level
    read: level
    request: [{ is: address, text: 4 }, { name: end, constant: "\r" }]
    answer: [{ is: address, text: 4 }, { name: is, constant: "=" },
             { name: mark, is: value, bytes: 2 }]
  - name: set
    write: level
    request: [{ is: address, text: 4 }, { name: set, constant: "S" },
              { name: mark, is: value, bytes: 2 }]
    answer: [{ is: address, text: 4 }, { name: did, constant: "!" }]
)",
                                                         "controllers.yaml");
  ASSERT_TRUE(declaration) << config::to_text(std::span(declaration.error()));
  expect_all_pass(subjects_of(*declaration));
}

TEST(SimCheck, PassesWithABlockThatIsOneLine) {
  const auto declaration = config::load_declaration_text(R"(
summary: weather transmitters
addresses: { from: 1, to: 9 }
areas: [{ name: message, record: true }]
operations:
  - name: send
    read: message
    request: [{ name: ask, constant: "SEND " }, { is: address }, { name: end, constant: "\r" }]
    answer:
      - { name: pressure, is: value, key: "P=", text: decimal(10), until: "hPa" }
      - { name: temperature, is: value, key: "T=", text: decimal(10), until: "'C" }
      - { name: end, constant: "\r\n" }
)",
                                                         "weather.yaml");
  ASSERT_TRUE(declaration) << config::to_text(std::span(declaration.error()));
  expect_all_pass(subjects_of(*declaration));
}

// VE.Direct protocol (Victron Energy): each value has a line of its own, and all bytes add up to 0.
TEST(SimCheck, PassesWithKeysThatContainLineBreaks) {
  expect_all_pass({declared_as(R"(
summary: solar chargers
addresses: { from: 1, to: 1 }
areas: [{ name: state, record: true }]
operations:
  - name: block
    read: state
    unsolicited: 1s
    answer:
      - { name: begin, constant: "\r\nPID\t" }
      - { name: product, is: value, text: 8, variable: true }
      - { name: line, constant: "\r" }
      - { name: voltage, is: value, key: "\nV\t", text: decimal(8), until: "\r" }
      - { name: panel, is: value, key: "\nVPV\t", text: decimal(8), until: "\r" }
      - { name: label, constant: "Checksum\t" }
      - { is: checksum, kind: sum, complement: twos, of: begin..label }
)")},
                  kOfUnsolicited);
}

// As in the frames of Pylontech batteries: a check of four bits and a length of twelve.
TEST(SimCheck, PassesWithALengthThatSharesItsBytes) {
  expect_all_pass({declared_as(R"(
summary: batteries
addresses: { from: 2, to: 17 }
encoding: hex
bit-order: high-first
areas: [{ name: state, record: true }]
operations:
  - name: read
    read: state
    request: [{ name: begin, constant: "~" }, { is: address }, { name: end, constant: "\r" }]
    answer:
      - { name: begin, constant: "~" }
      - { is: address }
      - { is: unused, bits: 4 }
      - { is: length, of: flag..cell-3, bits: 12, counts: characters }
      - { name: flag, is: value }
      - { repeat: 3, fields: [{ name: cell, is: value, bytes: 2 }] }
      - { is: checksum, kind: sum, complement: twos, of: address..cell-3, bytes: 2 }
      - { name: end, constant: "\r" }
)")});
}

TEST(SimCheck, PassesWithATextBeforeItsChecksum) {
  expect_all_pass({declared_as(R"(
summary: transmitters
addresses: { from: 1, to: 9 }
areas: [{ name: state, record: true }]
operations:
  - name: read
    read: state
    request: [{ name: ask, constant: "#" }, { is: address }]
    answer:
      - { name: begin, constant: ">" }
      - { is: address }
      - { name: level, is: value, text: decimal(8), variable: true }
      - { is: checksum, kind: sum, of: begin..level, as: hex, digits: 2 }
      - { name: end, constant: "\r" }
)")});
}

TEST(SimCheck, PassesWithTagsOfEitherKind) {
  for (const char* blocks : {"tag-value", "tag-length-value"}) {
    expect_all_pass({declared_as("blocks: " + std::string(blocks) + R"(
summary: sensors
addresses: { from: 1, to: 9 }
areas: [{ name: state, record: true }]
operations:
  - name: read
    read: state
    request: [{ name: ask, constant: "R" }, { is: address }]
    answer:
      - { name: begin, constant: "r" }
      - { is: length, of: length..checksum, bytes: 2 }
      - { is: address }
      - { name: settings, is: unused, key: [0x07], bytes: 3 }
      - { name: level, is: value, key: [0x13], bytes: 2, signed: true }
      - { name: title, is: value, key: "T", text: 4 }
      - { name: spare, is: unused, key: [0x15], text: 2 }
      - { is: checksum, kind: sum, of: begin..spare, bytes: 2 }
)")});
  }
}

}  // namespace
}  // namespace fieldcast::sim
