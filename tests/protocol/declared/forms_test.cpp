// Tests repeated fields, several forms of a response, and several forms of a refusal.
#include <gtest/gtest.h>

#include "tests/support/declared_device.hpp"
#include "tests/support/drive.hpp"
#include "tests/support/matrix.hpp"
#include "tests/support/multimeter.hpp"

namespace fieldcast::test {
namespace {

Bytes bytes(std::string_view digits) { return from_hex(digits).value(); }

// A battery monitor: a voltage and a temperature for each of three cells.
constexpr std::string_view kBattery = R"(
summary: battery monitor
addresses: { from: 1, to: 9 }
areas: [{ name: cells, record: true }]
operations:
  - name: read
    read: cells
    request: [{ name: head, constant: 0xA5 }, { is: address },
              { is: checksum, kind: sum, of: head..address }]
    answer:
      - { name: head, constant: 0x5A }
      - repeat: 3
        fields:
          - { name: voltage, is: value, bytes: 2 }
          - { name: warm, is: value, bits: 1 }
          - { is: unused, bits: 7 }
      - { is: checksum, kind: sum, of: voltage-1..unused-3 }
)";

TEST(Repeated, FieldsHaveNumberedNames) {
  EXPECT_THROW(declared_by(kBattery, 1), std::invalid_argument) << "unused fields have no number";
  std::string text(kBattery);
  text.replace(text.find("voltage-1..unused-3"), 19, "head");
  const Device battery = declared_by(text, 1);
  const auto read = [&](std::string_view at, const Bytes& response) {
    const auto exchange = battery.protocol().begin(battery.read(at, 1), {1, nullptr});
    return drive(*exchange, {response});
  };
  const Bytes response = bytes("5A 0CE4 01 0CE5 00 0CE6 01 5A");
  EXPECT_EQ(read("voltage-1", response).reply[0].items, (Bytes{0x0C, 0xE4}));
  EXPECT_EQ(read("voltage-3", response).reply[0].items, (Bytes{0x0C, 0xE6}));
  EXPECT_EQ(read("warm-3", response).reply[0].items, (Bytes{0, 1}));
  EXPECT_FALSE(battery.protocol().parse_address("voltage-4"));
  EXPECT_FALSE(battery.protocol().parse_address("voltage"));
}

// Of the lines of a block, a declaration names only some.
TEST(FormsWithBlocks, MayBeLong) {
  const Device meter = declared_by(R"(
summary: a meter that sends its state or all lines
addresses: { from: 1, to: 9 }
areas: [{ name: readout, record: true }]
operations:
  - name: read
    read: readout
    request: [{ name: ask, constant: "R" }, { is: address }]
    answers:
      - [{ name: short, constant: "S" }, { name: state, is: value }, { name: end, constant: "\n" }]
      - [{ name: long, constant: "L" }, { name: energy, is: value, key: "1.8.0(", text: 6 },
         { name: end, constant: "!\n" }]
)",
                                   1);
  std::string response = "L";
  for (int line = 0; line < 40; ++line) response += "32.7.0(230.1*V)\r\n";
  response += "1.8.0(001234)\r\n!\n";
  const auto exchange = meter.protocol().begin(meter.read("energy", 3), {1, nullptr});
  const auto outcome = drive(*exchange, {Bytes(response.begin(), response.end())});
  ASSERT_TRUE(outcome.done()) << to_text(outcome.cause);
  EXPECT_EQ(to_hex(outcome.reply[0].items), to_hex(bytes("303031323334")));
}

// A device whose session has ended may refuse each request.
TEST(Login, IsRepeatedAfterARefusal) {
  const Device device = declared_by(R"(
summary: a device with a login
addresses: { from: 1, to: 9 }
areas: [{ name: state, record: true }]
login:
  - request: [{ name: hello, constant: "L" }, { is: address }]
    answer: [{ name: welcome, constant: "W" }]
operations:
  - name: read
    read: state
    request: [{ name: ask, constant: "R" }, { is: address }]
    answer: [{ name: begin, constant: "S" }, { name: level, is: value }]
errors: { frame: [{ name: refused, constant: "N" }, { name: code, is: error }] }
)",
                                    1);
  Bytes session;
  const auto sent = [&](std::vector<Bytes> responses) {
    const auto exchange = device.protocol().begin(device.read("level", 1), {.session = &session});
    return drive(*exchange, responses).sent;
  };
  const Bytes login = bytes("4C01"), request = bytes("5201");
  EXPECT_EQ(sent({bytes("57"), bytes("5305")}), (std::vector<Bytes>{login, request}));
  EXPECT_EQ(sent({bytes("4E02")}), (std::vector<Bytes>{request}));
  EXPECT_EQ(sent({bytes("57"), bytes("5305")}), (std::vector<Bytes>{login, request}));
}

// Each group has its own checksum, over its own fields.
TEST(Repeated, SpansNameTheFieldsOfTheirRepetition) {
  const Device device = declared_by(R"(
summary: two groups, each with its sum
addresses: { from: 1, to: 9 }
areas: [{ name: state, record: true }]
operations:
  - name: read
    read: state
    request: [{ name: head, constant: 0xA5 }, { is: address }]
    answer:
      - { name: head, constant: 0x5A }
      - repeat: 2
        fields:
          - { name: level, is: value }
          - { name: limit, is: value }
          - { name: sum, is: checksum, kind: sum, of: level..limit }
)",
                                    1);
  const auto request = device.read("level-1", 4);
  const auto read = [&](const Bytes& response) {
    return drive(*device.protocol().begin(request, {1, nullptr}), {response});
  };
  EXPECT_EQ(read(bytes("5A 01 02 03 04 05 09")).reply[0].items, bytes("0001 0002 0004 0005"));
  EXPECT_EQ(read(bytes("5A 01 02 03 04 05 08")).cause, Cause::kChecksum);
  expect_matrix({.begin =
                     [&] {
                       return device.protocol().begin(request, {1, nullptr});
                     },
                 .answers = {bytes("5A 01 02 03 04 05 09")},
                 .checked = true});
}

class Forms : public testing::Test {
 protected:
  Outcome read(std::string_view at, const Bytes& response) {
    return drive(*meter_.protocol().begin(meter_.read(at, 1), {1, nullptr}), {response});
  }
  const Device meter_ = declared_by(kMultimeter, 1);
  const Bytes volts_ = bytes("56 00E6 63 D3"), amperes_ = bytes("41 63 00000102 21");
};

TEST_F(Forms, EachFormHasItsValues) {
  EXPECT_EQ(read("volts", volts_).reply[0].items, (Bytes{0x00, 0xE6}));
  EXPECT_EQ(read("battery", volts_).reply[0].items, (Bytes{0, 0x63}));
  EXPECT_EQ(read("battery", amperes_).reply[0].items, (Bytes{0, 0x63}));
}

TEST_F(Forms, AValueThatTheFormDoesNotHaveIsRefused) {
  EXPECT_EQ(read("volts", amperes_).cause, Cause::kDeviceError);
  EXPECT_EQ(read("volts", amperes_).reply.size(), 0u);
}

TEST_F(Forms, ABrokenFormIsNoOtherForm) {
  for (const Bytes& good : {volts_, amperes_}) {
    for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
      Bytes broken = good;
      broken[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
      EXPECT_FALSE(read("battery", broken).done()) << to_hex(broken);
    }
  }
}

TEST_F(Forms, EachRefusalIsOne) {
  const Outcome fuse = read("volts", bytes("3F 07"));
  EXPECT_EQ(fuse.cause, Cause::kDeviceError);
  EXPECT_EQ(fuse.code, 7);
  EXPECT_EQ(read("volts", bytes("42555359")).cause, Cause::kDeviceError);
}

TEST_F(Forms, AreExplained) {
  const auto loaded = config::load_declaration_text(kMultimeter, "test.yaml");
  ASSERT_TRUE(loaded);
  for (const Bytes& frame : {volts_, amperes_, bytes("42555359"), bytes("3F 07")}) {
    const auto fields = declared::explain(*loaded->value, frame);
    EXPECT_TRUE(std::ranges::none_of(fields, [](const auto& field) {
      return !field.fault.empty();
    })) << to_hex(frame);
  }
}

}  // namespace
}  // namespace fieldcast::test
