#include <gtest/gtest.h>

#include "core/protocol/families/registry.hpp"
#include "tests/support/device.hpp"
#include "tests/support/matrix.hpp"
#include "tests/support/text_cases.hpp"
#include "tests/support/vectors.hpp"

namespace fieldcast::test {
namespace {

Bytes text(std::string_view characters) { return {characters.begin(), characters.end()}; }
std::string text(const Bytes& bytes) { return {bytes.begin(), bytes.end()}; }
Device station(std::uint16_t address) { return {"s7-freeport", address}; }

bool has_fault(const std::vector<FrameField>& fields) {
  return std::any_of(fields.begin(), fields.end(),
                     [](const FrameField& field) { return !field.fault.empty(); });
}

// The digits of a published request, parsed without the codec.
struct Meant {
  std::uint16_t station;
  std::uint32_t length;
  std::string data;
  explicit Meant(const std::string& q)
      : station(static_cast<std::uint16_t>(std::stoul(q.substr(2, 2), nullptr, 16))),
        length(static_cast<std::uint32_t>(std::stoul(q.substr(4, 2), nullptr, 16))),
        data(q.substr(6, 2 * length)) {}
};

TEST(FreeportVectors, RequestsAndResponsesAreTheirs) {
  for (const GoldenVector& vector : load_vectors("freeport")) {
    if (vector.kind != "ok") continue;
    SCOPED_TRACE(vector.name);
    const std::string q = text(vector.request);
    const Meant meant(q);
    const Device device = station(meant.station);
    const Request request =
        q[1] == 'W' ? device.read("window:0", meant.length) : device.write("window:0", meant.data);
    EXPECT_EQ(text(device.request_bytes(request)), q);
    const auto exchange = device.begin(request);
    const Outcome outcome = drive(*exchange, vector.response);
    ASSERT_TRUE(outcome.done()) << to_text(outcome);
    const std::string answered = text(vector.response).substr(1, 2 * meant.length);
    EXPECT_EQ(to_hex(outcome.reply.at(0).items, '\0'), q[1] == 'W' ? answered : "");
    expect_matrix({.begin = [&] { return device.begin(request); }, .answers = {vector.response}});
    EXPECT_FALSE(has_fault(find_protocol("s7-freeport")->explain(vector.request)));
    EXPECT_FALSE(has_fault(find_protocol("s7-freeport")->explain(vector.response)));
  }
}

TEST(FreeportVectors, RefusalsAreTheirCodeAndBrokenResponsesNoValue) {
  for (const GoldenVector& vector : load_vectors("freeport")) {
    if (vector.kind == "ok") continue;
    SCOPED_TRACE(vector.name);
    const Device device = station(5);
    const auto exchange = device.begin(device.read("window:0", 4));
    const Outcome outcome = drive(*exchange, vector.response);
    EXPECT_FALSE(outcome.done());
    EXPECT_EQ(outcome.cause == Cause::kDeviceError, vector.name == "refusal_command");
    if (vector.kind == "exception") { EXPECT_EQ(outcome.code, vector.response[3] - '0'); }
    // A fault that the station finds in a frame is a line error, so the request is retried.
    if (vector.kind == "exception" && vector.name != "refusal_command") {
      EXPECT_EQ(outcome.cause, Cause::kChecksum);
    }
    EXPECT_EQ(has_fault(find_protocol("s7-freeport")->explain(vector.response)),
              vector.kind == "malformed");
  }
}

TEST(Freeport, TheMatrixHolds) {
  const Device device = station(5);
  MatrixCase matrix{.begin = [&] { return device.begin(device.read("window:0", 4)); },
                    .answers = {text("qC911F57C7DQ")}};
  expect_matrix(matrix);
  expect_random_bytes_are_refused(matrix, 1, 5000);
  matrix = {.begin = [&] { return device.begin(device.write("window:0", "C911F57C")); },
            .answers = {text("qC911F57C7DQ")}};
  expect_matrix(matrix);
  matrix.answers = {text("qE0441Q")};  // refused
  expect_matrix(matrix);
}

TEST(Freeport, AByteFromTheMiddleIsCutOutOfTheWindow) {
  const Device device = station(5);
  const Request request = device.read("window:2", 1);
  EXPECT_EQ(text(device.request_bytes(request)).substr(4, 2), "03");
  const auto exchange = device.begin(request);
  const Outcome outcome = drive(*exchange, text("q3DAAD8000BQ"));
  ASSERT_TRUE(outcome.done());
  EXPECT_EQ(to_hex(outcome.reply[0].items), "D8");
}

TEST(Freeport, BytesPastTheLengthMustBeZeroInAReadsResponse) {
  const Device device = station(5);
  const auto exchange = device.begin(device.read("window:0", 2));
  EXPECT_EQ(drive(*exchange, text("q3DAAD8000BQ")).cause, Cause::kMalformed);
}

TEST(Freeport, AWriteOfALaterByteSendsTheEarlierOnesAgain) {
  const Device device = station(5);
  const auto first = device.begin(device.write("window:0", "C911"));
  ASSERT_TRUE(drive(*first, text("qC911F57C7DQ")).done());  // also reports what follows
  EXPECT_EQ(text(device.request_bytes(device.write("window:3", "AB"))).substr(0, 14),
            "qR0504C911F5AB");
  EXPECT_EQ(text(device.request_bytes(device.write_bit("window:1.7", true))).substr(0, 14),
            "qR0502C9910000");
}

// The other outputs of the PLC would become zero.
TEST(Freeport, AWriteThatNeedsUnknownBytesIsNotPossible) {
  const Device device = station(5);
  const auto possible = [&](const Request& request) {
    return device.protocol().size(request).has_value();
  };
  EXPECT_FALSE(possible(device.write("window:2", "AB")));
  EXPECT_FALSE(possible(device.write_bit("window:0.7", true)));
  EXPECT_TRUE(possible(device.write("window:0", "C9")));
  const auto refused = device.begin(device.write("window:0", "C9"));
  EXPECT_FALSE(drive(*refused, text("qE0441Q")).done());
  EXPECT_FALSE(possible(device.write("window:2", "AB")));
  const auto first = device.begin(device.write("window:0", "C9"));
  ASSERT_TRUE(drive(*first, text("qC911F57C7DQ")).done());
  EXPECT_TRUE(possible(device.write("window:2", "AB")));
  EXPECT_TRUE(possible(device.write_bit("window:0.7", true)));
}

TEST(Freeport, UnknownBytesMayBeDeclaredZero) {
  const Device device("s7-freeport", 5, {{"unknown-bytes", "zero"}});
  EXPECT_EQ(text(device.request_bytes(device.write("window:2", "AB"))).substr(0, 14),
            "qR05030000AB00");
}

TEST(Freeport, AResponseThatHoldsAnotherValueIsNotAConfirmation) {
  const Device device = station(5);
  const auto exchange = device.begin(device.write("window:0", "C910"));
  EXPECT_EQ(drive(*exchange, text("qC911F57C7DQ")).cause, Cause::kMalformed);
}

TEST(Freeport, AWriteIsReadBackByItsOwnResponse) {
  const Device device = station(5);
  const auto write = std::get<WriteRequest>(device.write("window:0", "C911"));
  const auto exchange = device.begin(WriteReadRequest{write, write.range});
  const Outcome outcome = drive(*exchange, text("qC911F57C7DQ"));
  ASSERT_TRUE(outcome.done());
  ASSERT_EQ(outcome.reply.size(), 2u);
  EXPECT_EQ(to_hex(outcome.reply[1].items), "C9 11");
}

TEST(Freeport, SwappedLettersTurnTheDirections) {
  const Device device("s7-freeport", 5, {{"letters", "swapped"}});
  EXPECT_EQ(device.request_bytes(device.read("window:0", 4))[1], 'R');
  EXPECT_EQ(device.request_bytes(device.write("window:0", "01"))[1], 'W');
}

TEST(Freeport, PlacesOutsideTheWindowAreRefused) {
  const Device device = station(5);
  for (const auto* at : {"window:4", "window:0.8", "window:", "window", "window:1.", "window:11",
                         "window:0.11", "V100", ""}) {
    const auto parsed = device.protocol().parse_address(at);
    ASSERT_FALSE(parsed.has_value()) << at;
    EXPECT_TRUE(device.protocol().parse_address(parsed.error().suggestion).has_value());
  }
  EXPECT_FALSE(device.protocol().size(ReadRequest{{{0, 3, 2}}}).has_value());
  EXPECT_FALSE(device.protocol().size(ReadRequest{{{0, 0xFFFFFFFF, 2}}}).has_value());
  EXPECT_FALSE(device.protocol().size(ReadRequest{{{0, 0, 1}, {0, 2, 1}}}).has_value());
}

TEST(Freeport, BitsHaveAWidth) {
  const auto bit = station(5).protocol().parse_address("window:1.5");
  ASSERT_TRUE(bit.has_value());
  EXPECT_EQ(bit->first, 1u);
  EXPECT_EQ(bit->bit, 5);
  EXPECT_EQ(bit->width_bits, 1u);
}

TEST(Freeport, WhatIsNotAFrameIsRefusedWithAReason) {
  const auto fault = [](std::string_view frame) {
    return find_protocol("s7-freeport")->explain(text(frame)).at(0).fault.substr(0, 20);
  };
  expect_texts(fault, {"W0504 -> begins without q: a ", "qEB8 -> ends without Q: a re",
                       "qEB8Q -> 5 characters: a requ", " -> no character"});
}

}  // namespace
}  // namespace fieldcast::test
