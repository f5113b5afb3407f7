#include <gtest/gtest.h>

#include "core/codec/value_codec.hpp"
#include "tests/support/declared_device.hpp"
#include "tests/support/matrix.hpp"

namespace fieldcast::test {
namespace {

Device instrument() { return declared_device("instrument", 7); }

// header, status 3, analog 23.5, unit 2, outputs 1001b and inputs 0101b, tail
const Bytes kAnswer = *from_hex("AA 03 41 BC 00 00 02 95 55");

Value value_at(const Device& device, std::string_view at, ValueType type) {
  const auto parsed = device.protocol().parse_address(at);
  if (!parsed) return std::string("no address");
  Encoding encoding{.type = type, .bit = parsed->bit};
  const ReadRequest read{{{parsed->area, parsed->first, item_count(encoding, 16)}}};
  const auto exchange = device.begin(read);
  const auto outcome = drive(*exchange, kAnswer);
  if (!outcome.done()) return to_text(outcome);
  return decode_value(encoding, 16, outcome.reply[0].items).value_or(std::string("out of range"));
}

TEST(Instrument, IsAskedByHeaderAddressCommandAndSum) {
  const Device device = instrument();
  EXPECT_EQ(to_hex(device.request_bytes(device.read("status"))), "AA 07 01 B2");
  const auto size = device.protocol().size(device.read("status"));
  ASSERT_TRUE(size);
  EXPECT_EQ(size->request_characters, 4u);
  EXPECT_EQ(size->response_characters, 9u);
}

TEST(Instrument, ItsResponseIsCutIntoItsFields) {
  const Device device = instrument();
  EXPECT_EQ(value_at(device, "status", ValueType::kUint16), Value(std::uint64_t{3}));
  EXPECT_EQ(value_at(device, "analog", ValueType::kFloat32), Value(23.5));
  EXPECT_EQ(value_at(device, "unit", ValueType::kUint16), Value(std::uint64_t{2}));
  EXPECT_EQ(value_at(device, "input", ValueType::kUint16), Value(std::uint64_t{5}));
  EXPECT_EQ(value_at(device, "output", ValueType::kUint16), Value(std::uint64_t{9}));
  for (unsigned bit = 0; bit < 4; ++bit) {
    EXPECT_EQ(value_at(device, "input." + std::to_string(bit), ValueType::kBool),
              Value((5u >> bit & 1u) != 0))
        << bit;
    EXPECT_EQ(value_at(device, "output." + std::to_string(bit), ValueType::kBool),
              Value((9u >> bit & 1u) != 0))
        << bit;
  }
}

TEST(Instrument, OneReadBringsTheWholeRecord) {
  const Device device = instrument();
  ASSERT_EQ(device.protocol().areas().size(), 1u);
  EXPECT_TRUE(device.protocol().areas()[0].window);
  EXPECT_EQ(device.protocol().areas()[0].items, 6u);
  const auto exchange = device.begin(device.read("status", 6));
  const auto outcome = drive(*exchange, kAnswer);
  ASSERT_TRUE(outcome.done());
  EXPECT_EQ(to_hex(outcome.reply[0].items), "00 03 41 BC 00 00 00 02 00 05 00 09");
}

TEST(Instrument, OutputsAreWrittenAndTheResponseMustShowThem) {
  const Device device = instrument();
  const Request request = device.write("output", "0009");
  EXPECT_EQ(to_hex(device.request_bytes(request)), "AA 07 02 09 BC");
  EXPECT_TRUE(drive(*device.begin(request), kAnswer).done());
  EXPECT_EQ(drive(*device.begin(device.write("output", "0008")), kAnswer).cause, Cause::kMalformed);
}

TEST(Instrument, WhatItsFieldsCannotHoldIsNotSent) {
  const Device device = instrument();
  EXPECT_FALSE(device.protocol().size(device.write("output", "0010")).has_value());
  EXPECT_FALSE(device.protocol().size(device.write("status", "0001")).has_value());
  EXPECT_FALSE(device.protocol().size(device.write("input", "00010002")).has_value());
  EXPECT_FALSE(device.protocol().size(device.read("output", 2)).has_value());
}

TEST(Instrument, TheMatrixHolds) {
  const Device device = instrument();
  // The response has no check, so a flipped bit of a value cannot be detected.
  expect_matrix({.begin = [&] { return device.begin(device.read("status", 6)); },
                 .answers = {kAnswer},
                 .checked = false});
}

TEST(Instrument, ALineThatBabblesIsGivenUpAfterTwoFrames) {
  const Device device = instrument();
  Bytes babble(2 * kAnswer.size() + 64, 0x11);
  EXPECT_EQ(drive(*device.begin(device.read("status")), babble).cause, Cause::kMalformed);
  babble.push_back(0x11);
  EXPECT_EQ(drive(*device.begin(device.read("status")), babble).cause, Cause::kOverlong);
}

TEST(Instrument, AResponseWithoutAnAddressIsNobodys) {
  EXPECT_EQ(instrument().protocol().traits().identity, ResponseIdentity::kNone);
}

TEST(Instrument, PlacesHaveNamesAndNearMisses) {
  const Device device = instrument();
  for (const auto* at : {"statu", "input.4", "analog.32", "output.", "tail", "", "input.x"}) {
    EXPECT_FALSE(device.protocol().parse_address(at).has_value()) << at;
  }
  EXPECT_EQ(device.protocol().parse_address("statuss").error().suggestion, "status");
  EXPECT_EQ(device.protocol().parse_address("input.4").error().suggestion, "input.3");
  EXPECT_EQ(device.protocol().parse_address("analog")->width_bits, 32u);
  EXPECT_EQ(device.protocol().parse_address("analog.17")->first, 1u);
}

TEST(Instrument, FramesAreExplained) {
  const auto declaration = test::declaration("instrument");
  const auto has = [](const std::vector<FrameField>& fields, std::string_view name,
                      std::string_view value) {
    return std::any_of(fields.begin(), fields.end(), [&](const FrameField& field) {
      return field.name == name && field.value == value;
    });
  };
  const auto faults = [](const std::vector<FrameField>& fields) {
    return std::count_if(fields.begin(), fields.end(),
                         [](const FrameField& field) { return !field.fault.empty(); });
  };
  const auto answer = explain(*declaration, kAnswer);
  EXPECT_EQ(faults(answer), 0);
  EXPECT_TRUE(has(answer, "status", "3"));
  EXPECT_TRUE(has(answer, "output", "9"));
  EXPECT_EQ(faults(explain(*declaration, *from_hex("AA 07 01 B2"))), 0);
  const auto broken = explain(*declaration, *from_hex("AA 07 01 B3"));
  EXPECT_EQ(faults(broken), 1);
  EXPECT_EQ(broken.back().value, "B3");
  EXPECT_EQ(broken.back().fault, "should be B2");
}

}  // namespace
}  // namespace fieldcast::test
