// Tests blocks of values that begin with a tag.
#include <gtest/gtest.h>

#include "tests/support/declared_device.hpp"
#include "tests/support/drive.hpp"
#include "tests/support/matrix.hpp"

namespace fieldcast::test {
namespace {

constexpr std::string_view kSensor = R"(
summary: sensors that send tags
addresses: { from: 1, to: 9 }
blocks: tag-value
areas: [{ name: state, record: true }]
operations:
  - name: read
    read: state
    request: [{ name: ask, constant: "R" }, { is: address }]
    answer:
      - { name: begin, constant: "r" }
      - { is: length, of: skipped..title }
      - { name: skipped, is: unused, key: [0x07], bytes: 3 }
      - { name: level, is: value, key: [0x13], bytes: 2, signed: true }
      - { name: digits, is: value, key: [0x14], as: bcd, bytes: 2 }
      - { name: title, is: value, key: "T", text: 4 }
      - { is: checksum, kind: sum, of: begin..title }
)";

std::string of_lengths() {
  std::string text(kSensor);
  return text.replace(text.find("tag-value"), 9, "tag-length-value");
}

class Tags : public testing::Test {
 protected:
  static Bytes hex(std::string_view digits) { return from_hex(digits).value(); }
  static std::string read(const Device& sensor, std::string_view at, std::uint32_t items,
                          std::string_view block) {
    Bytes response = hex("72 00");
    append(response, hex(block));
    response[1] = static_cast<std::uint8_t>(response.size() - 2);
    std::uint8_t sum = 0;
    for (const std::uint8_t byte : response) sum = static_cast<std::uint8_t>(sum + byte);
    response.push_back(sum);
    const auto outcome = drive(*sensor.begin(sensor.read(at, items)), response);
    return outcome.done() ? to_hex(outcome.reply[0].items) : std::string(to_text(outcome.cause));
  }
  const Device sensor_ = declared_by(kSensor, 1);
  const std::string absent_ = std::string(to_text(Cause::kDeviceError));
};

TEST_F(Tags, HaveAnyOrder) {
  for (const std::string block : {"13 FFFE 14 1234 54 41424344", "54 41424344 14 1234 13 FFFE"}) {
    EXPECT_EQ(read(sensor_, "level", 1, block), "FF FE");
    EXPECT_EQ(read(sensor_, "digits", 1, block), "04 D2");
    EXPECT_EQ(read(sensor_, "title", 2, block), "41 42 43 44");
  }
  EXPECT_EQ(read(sensor_, "level", 1, "14 1234"), absent_);
}

// A tag is only a tag where one is expected: here 13 and 14 are bytes of values.
TEST_F(Tags, AreNotSearchedInValues) {
  EXPECT_EQ(read(sensor_, "level", 1, "07 131313 14 1314 13 0005"), "00 05");
  EXPECT_EQ(read(sensor_, "digits", 1, "13 1414 14 0009"), "00 09");
}

TEST_F(Tags, AnUnknownTagEndsTheBlock) {
  EXPECT_EQ(read(sensor_, "level", 1, "13 0005 99 14 1234"), "00 05");
  EXPECT_EQ(read(sensor_, "digits", 1, "13 0005 99 14 1234"), absent_);
  EXPECT_EQ(read(sensor_, "digits", 1, "14 12"), absent_);
}

TEST_F(Tags, ALengthBehindATagSkipsUnknownOnes) {
  const Device sensor = declared_by(of_lengths(), 1);
  const std::string block = "99 03 131313 13 02 FFFE 54 02 4142 14 02 1234";
  EXPECT_EQ(read(sensor, "level", 1, block), "FF FE");
  EXPECT_EQ(read(sensor, "digits", 1, block), "04 D2");
  EXPECT_EQ(read(sensor, "title", 2, block), "41 42 00 00");
  EXPECT_EQ(read(sensor, "level", 1, "13 03 00FFFE"), absent_) << "another length is another value";
  EXPECT_EQ(read(sensor, "level", 1, "99 FF 13 02 FFFE"), absent_);
  EXPECT_EQ(read(sensor, "level", 1, "99 01 00 13"), absent_) << "a tag without its length";
}

TEST_F(Tags, ThroughAllDisturbances) {
  expect_matrix({.begin = [&] { return sensor_.begin(sensor_.read("level", 1)); },
                 .answers = {hex("72 06 13 0005 14 1234 EA")},
                 .checked = true});
}

TEST_F(Tags, AreExplained) {
  const auto loaded = config::load_declaration_text(kSensor, "test.yaml");
  const auto fields = declared::explain(*loaded->value, hex("72 06 13 0005 14 1234 EA"));
  const auto shows = [&](std::string_view name, std::string_view value) {
    return std::ranges::any_of(fields, [&](const FrameField& field) {
      return field.name == name && field.value == value && field.fault.empty();
    });
  };
  EXPECT_TRUE(shows("level", "5"));
  EXPECT_TRUE(shows("digits", "1234"));
  EXPECT_TRUE(shows("title", "not in this frame"));
}

}  // namespace
}  // namespace fieldcast::test
