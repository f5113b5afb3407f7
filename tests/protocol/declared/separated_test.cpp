// Tests items between separators, numbers of variable width, and numbers of channels.
#include <gtest/gtest.h>

#include "core/protocol/declared/word.hpp"
#include "tests/support/declared_device.hpp"
#include "tests/support/drive.hpp"

namespace fieldcast::test {
namespace {

// Constructed: signed numbers between commas, contacts of a channel, hexadecimal words.
constexpr std::string_view kLists = R"(
summary: lists of numbers
addresses: { from: 1, to: 99 }
areas:
  - { name: level, item: 32bit, items: 1000 }
  - { name: contact, prefix: C, item: bit, base: channel, items: 3200 }
  - { name: word, prefix: W, base: hexadecimal, items: 0x1000 }
operations:
  - name: read levels
    read: level
    count: 20
    request:
      - &ask { name: ask, constant: "?" }
      - &unit { is: address, as: decimal, digits: 2, variable: true }
      - { name: area, constant: ":L" }
      - &first { is: first, as: decimal, digits: 3, variable: true }
      - &gap { name: gap, constant: "," }
      - &count { is: count, as: decimal, digits: 2, variable: true }
      - &end { name: end, constant: "\r" }
    answer:
      - *unit
      - &colon { name: colon, constant: ":" }
      - &levels { is: items, as: decimal, digits: 10, variable: true, signed: true, separator: "," }
      - *end
  - name: write levels
    write: level
    count: 20
    request:
      - { name: set, constant: "!" }
      - *unit
      - { name: area, constant: ":L" }
      - *first
      - *gap
      - *count
      - *gap
      - *levels
      - *end
    answer: [*unit, { name: done, constant: " OK\r" }]
  - name: read contacts
    read: contact
    count: 20
    request:
      - *ask
      - *unit
      - { name: area, constant: ":C" }
      - { is: first, as: channel, digits: 5, variable: true }
      - *gap
      - *count
      - *end
    answer:
      - *unit
      - *colon
      - { is: items, as: decimal, digits: 1, on: 1, off: 0, separator: ", " }
      - *end
  - name: read words
    read: word
    count: 20
    request:
      - *ask
      - *unit
      - { name: area, constant: ":W" }
      - { is: first, as: hex, digits: 4, variable: true }
      - *gap
      - *count
      - *end
    answer: [*unit, *colon, { is: items, as: hex, variable: true, separator: "/" }, *end]
)";

std::string text_sent(const Device& device, const Request& request) {
  const Bytes sent = device.request_bytes(request);
  return {sent.begin(), sent.end()};
}

std::string received(const Device& device, const Request& request, std::string_view response) {
  const Outcome outcome = drive(*device.begin(request), Bytes(response.begin(), response.end()));
  return outcome.done() ? to_hex(outcome.reply[0].items) : to_text(outcome);
}

TEST(SeparatedItems, OfAnyWidthAndSignAreRead) {
  const Device device = declared_by(kLists, 7);
  const Request read = device.read("level:5", 3);
  EXPECT_EQ(text_sent(device, read), "?7:L5,3\r");
  EXPECT_EQ(received(device, read, "7:12,-7,2147483647\r"), "00 00 00 0C FF FF FF F9 7F FF FF FF");
  EXPECT_EQ(received(device, read, "07:0012,+7,-2147483648\r"),
            "00 00 00 0C 00 00 00 07 80 00 00 00");
}

TEST(SeparatedItems, WithTooFewTooManyOrOtherCharactersAreNotAResponse) {
  const Device device = declared_by(kLists, 7);
  const Request read = device.read("level:5", 3);
  for (const char* response :
       {"7:12,-7\r", "7:12,-7,1,2\r", "7:12,,1\r", "7:12,-,1\r", "7:12;-7;1\r", "7:12,-7,1x\r",
        "7:12,-7,2147483648\r", "7:12,-7,-2147483649\r", "7:12,-7,00000000012\r", "8:12,-7,1\r"})
    EXPECT_TRUE(received(device, read, response).starts_with("failed")) << response;
}

TEST(SeparatedItems, AreReadInAnyPieces) {
  const Device device = declared_by(kLists, 7);
  const Request read = device.read("level:5", 3);
  const std::string response = "7:12,-7,345\r";
  for (std::size_t cut = 1; cut < response.size(); ++cut) {
    const std::size_t cuts[] = {cut};
    const std::vector<Bytes> answers{Bytes(response.begin(), response.end())};
    const Outcome outcome = drive(*device.begin(read), answers, cuts);
    ASSERT_TRUE(outcome.done()) << cut;
    EXPECT_EQ(to_hex(outcome.reply[0].items), "00 00 00 0C FF FF FF F9 00 00 01 59") << cut;
  }
}

TEST(SeparatedItems, AreWrittenWithoutLeadingZeros) {
  const Device device = declared_by(kLists, 12);
  const Request write = device.write("level:0", "00 00 00 00 FF FF FF F9 00 01 00 00");
  EXPECT_EQ(text_sent(device, write), "!12:L0,3,0,-7,65536\r");
  EXPECT_EQ(received(device, write, "12 OK\r"), "");
  EXPECT_GE(device.protocol().size(write)->request_characters, text_sent(device, write).size());
}

TEST(SeparatedItems, AreBitsAndHexadecimalNumbersToo) {
  const Device device = declared_by(kLists, 7);
  EXPECT_EQ(received(device, device.read("C0", 3), "7:1, 0, 1\r"), "01 00 01");
  EXPECT_TRUE(received(device, device.read("C0", 3), "7:1, 0, 2\r").starts_with("failed"));
  const Request words = device.read("WFF", 2);
  EXPECT_EQ(text_sent(device, words), "?7:WFF,2\r");
  EXPECT_EQ(received(device, words, "7:A/FFFF\r"), "00 0A FF FF");
}

TEST(Channels, HaveSixteenContacts) {
  const Device device = declared_by(kLists, 7);
  const auto first = [&](std::string_view at) {
    const std::string sent = text_sent(device, device.read(at, 1));
    return sent.substr(4, sent.find(',') - 4);
  };
  EXPECT_EQ(first("C5"), "5");
  EXPECT_EQ(first("C0115"), "115");
  EXPECT_EQ(first("C19915"), "19915");
  EXPECT_EQ(device.protocol().parse_address("C1015")->first + 1,
            device.protocol().parse_address("C1100")->first);
  EXPECT_FALSE(device.protocol().parse_address("C16"));
  EXPECT_FALSE(device.protocol().parse_address("C20000"));
}

TEST(SeparatedItems, AreExplained) {
  const auto loaded = config::load_declaration_text(kLists, "test.yaml");
  ASSERT_TRUE(loaded) << config::to_text(std::span(loaded.error()));
  const auto explained = [&](std::string_view frame) {
    std::string text;
    for (const FrameField& field :
         declared::explain(*loaded->value, Bytes(frame.begin(), frame.end())))
      text += field.name + "=" + field.value + (field.fault.empty() ? "" : "!" + field.fault) + "|";
    return text;
  };
  EXPECT_EQ(explained("!7:L5,2,12,-7\r"),
            "frame=request: write levels|set=!|address=7|area=:L|first=level:5|gap=,|count=2|gap=,|"
            "items=12 -7|end=0D|");
  EXPECT_NE(explained("?7:C1015,3\r").find("first=C1015"), std::string::npos);
  EXPECT_NE(explained("?7:C1016,3\r").find("!not a number of this field"), std::string::npos);
  EXPECT_NE(explained("!7:L5,2,12,x\r").find("!an item is not a number"), std::string::npos);
}

TEST(VariableWords, EndAtTheFirstOtherCharacter) {
  const declared::Word word{declared::Notation::kDecimal, 5, false, 16, true};
  const auto width = [&](std::string_view text) {
    return declared::width_of(Bytes(text.begin(), text.end()), word);
  };
  EXPECT_EQ(width("-12 "), 3u);
  EXPECT_EQ(width("12-"), 2u);
  EXPECT_EQ(width(""), 0u);
  for (const std::uint64_t number : {0u, 1u, 32767u, 32768u, 65535u}) {
    Bytes text;
    declared::append_word(text, word, number);
    EXPECT_LE(text.size(), declared::most_characters(word));
    EXPECT_EQ(declared::read_word(text, word), number);
  }
}

}  // namespace
}  // namespace fieldcast::test
