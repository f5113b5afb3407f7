// A response at another baud rate, which the device names in a round before the request.
#include <gtest/gtest.h>

#include "tests/support/declared_device.hpp"
#include "tests/support/drive.hpp"

namespace fieldcast::test {
namespace {

Bytes octets(std::string_view text) { return {text.begin(), text.end()}; }

// The request behind the identification with this code of a rate.
struct Asked {
  Step step;
  Bytes request;
};
Asked ask(const Device& device, char code) {
  const auto exchange = device.protocol().begin(device.read("power-import", 5), {});
  Asked asked;
  Bytes identify;
  EXPECT_EQ(exchange->start(identify).response_baud, 0u);
  EXPECT_EQ(identify, octets("/?!\r\n"));
  asked.step = exchange->on_bytes(octets(std::string("/ITR") + code + "EM214\r\n"), asked.request);
  if (asked.step.kind == Step::Kind::kNeedMore) asked.step = exchange->on_silence(asked.request);
  return asked;
}

TEST(Rate, TheRequestRepeatsTheCodeAndTheResponseHasItsRate) {
  const Device device = declared_device("iec62056-21-optical", 1);
  for (const auto& [code, baud] :
       std::map<char, std::uint32_t>{{'0', 300}, {'2', 1200}, {'5', 9600}, {'6', 19200}}) {
    const Asked asked = ask(device, code);
    EXPECT_EQ(asked.step.kind, Step::Kind::kSend) << code;
    EXPECT_EQ(asked.step.response_baud, baud) << code;
    EXPECT_EQ(asked.request, octets(std::string("\x06"
                                                "0") +
                                    code + "0\r\n"));
  }
}

TEST(Rate, AnUnknownCodeIsAMalformedResponse) {
  const Asked asked = ask(declared_device("iec62056-21-optical", 1), 'A');
  EXPECT_EQ(asked.step.kind, Step::Kind::kFailed);
  EXPECT_EQ(asked.step.cause, Cause::kMalformed);
}

TEST(Rate, AnExplainedFrameSaysTheRate) {
  const auto meter = declaration("iec62056-21-optical");
  const auto shown = [&](std::string_view frame) {
    for (const FrameField& field : declared::explain(*meter, octets(frame))) {
      if (field.name == "rate") return field.value + "/" + field.fault;
    }
    return std::string();
  };
  EXPECT_EQ(shown("/ITR5EM214\r\n"), "53 = 9600 baud/");
  EXPECT_EQ(shown("/ITRAEM214\r\n"), "65/no baud rate has this code");
}

// The plan counts with the usual rate: 9600 baud, 32 times as fast as the line of 300.
TEST(Rate, TheWireTimeIsThatOfBothRates) {
  const auto size_at = [](const std::string& protocol) {
    const Device device = declared_device(protocol, 1);
    return *device.protocol().size(device.read("power-import", 5));
  };
  const LineFormat line{};  // of the device, too
  LineFormat fast = line;
  fast.baud = 9600;
  const ExchangeSize changing = size_at("iec62056-21-optical"), fixed = size_at("iec62056-21");
  EXPECT_EQ(changing.request_characters, fixed.request_characters);
  const std::uint32_t readout = fixed.response_characters - changing.response_characters;
  EXPECT_GT(readout, 300u);
  EXPECT_EQ(changing.response_at_other_rate, fast.characters(readout));
  EXPECT_EQ(changing.wire_time(line),
            line.characters(changing.request_characters + changing.response_characters) +
                fast.characters(readout));
}

}  // namespace
}  // namespace fieldcast::test
