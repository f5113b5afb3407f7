#include "tools/sim/families/freeport_device.hpp"

#include <gtest/gtest.h>

#include "core/codec/checksum.hpp"
#include "tests/support/vectors.hpp"
#include "tests/tools/sim/device_setup.hpp"
#include "tests/tools/sim/listen.hpp"
#include "tools/sim/device/device.hpp"

namespace fieldcast::sim {
namespace {

using fieldcast::test::GoldenVector;
using test::device_setup;

std::string said(FreeportDevice& device, const std::string& request) {
  const Bytes answer = test::listen(*device.open_receiver(), test::bytes(request)).response;
  return {answer.begin(), answer.end()};
}

std::string framed(const std::string& text) {
  Bytes frame;
  append_hex(frame, xor8(test::bytes(text)), 2);
  return "q" + text + std::string(frame.begin(), frame.end()) + "Q";
}

TEST(FreeportDeviceVectors, RespondsAsPrinted) {
  int reads = 0, writes = 0;
  for (const GoldenVector& vector : fieldcast::test::load_vectors("freeport")) {
    if (vector.kind != "ok") continue;
    SCOPED_TRACE(vector.name);
    const std::string request(vector.request.begin(), vector.request.end());
    FreeportDevice device(
        device_setup(static_cast<std::uint16_t>(std::stoul(request.substr(2, 2), nullptr, 16))));
    const std::string answer(vector.response.begin(), vector.response.end());
    const Bytes window = *from_hex(answer.substr(1, 8));
    const auto length = std::stoul(request.substr(4, 2));
    const bool read = request[1] == 'W';
    for (std::uint32_t i = 0; read && i < 4; ++i)
      device.memory().write(0, i, i < length ? window[i] : 0xFF);
    EXPECT_EQ(said(device, request), answer);
    for (std::uint32_t i = 0; i < length; ++i)
      EXPECT_EQ(device.memory().read(0, i, test::kBegin), window[i]) << i;
    ++(read ? reads : writes);
  }
  EXPECT_GE(reads, 12);
  EXPECT_GE(writes, 12);
}

TEST(FreeportDeviceVectors, RefusesAsPrinted) {
  std::map<std::string, std::string> printed;
  for (const GoldenVector& vector : fieldcast::test::load_vectors("freeport")) {
    if (vector.kind == "exception")
      printed[vector.name] = {vector.response.begin(), vector.response.end()};
  }
  FreeportDevice device(device_setup(5));
  EXPECT_EQ(said(device, "qW05040000000000Q"), printed.at("refusal_check"));
  EXPECT_EQ(said(device, framed("W0505"
                                "00000000")),
            printed.at("refusal_length"));  // LE above four
  EXPECT_EQ(said(device, framed("W0504"
                                "0000000000")),
            printed.at("refusal_length"));
  EXPECT_EQ(said(device, framed("W0504"
                                "0000000g")),
            printed.at("refusal_digit"));
  EXPECT_EQ(said(device, framed("X0504"
                                "00000000")),
            printed.at("refusal_command"));
  EXPECT_EQ(device.statistics().write_requests, 0u);
}

TEST(FreeportDevice, OtherStationsAndTheirResponsesGetSilence) {
  FreeportDevice device(device_setup(5));
  EXPECT_EQ(said(device, framed("W0604"
                                "00000000")),
            "");
  // a response that begins like a request to this station
  EXPECT_EQ(said(device, framed("05040000")), "");
  EXPECT_EQ(said(device, framed("E05")), "");
  EXPECT_EQ(said(device, "W05040000000056Q"), "");
}

TEST(FreeportDevice, AMarkBeginsAFrameWhereverItStands) {
  FreeportDevice device(device_setup(5));
  const std::string read = framed(
      "W0504"
      "00000000");
  EXPECT_EQ(said(device, "qW05" + read), framed("00000000"));
  EXPECT_EQ(said(device, "q" + std::string(500, '0') + read), framed("00000000"));
}

TEST(FreeportDevice, SwappedLettersMeanTheOtherThing) {
  DeviceSetup setup = device_setup(5);
  setup.spec.link.options["letters"] = "swapped";
  FreeportDevice device(setup);
  EXPECT_EQ(said(device, framed("W0502"
                                "12340000")),
            framed("12340000"));
  EXPECT_EQ(said(device, framed("R0502"
                                "00000000")),
            framed("12340000"));
}

// The write window starts with zeros. A read-only channel keeps changing.
TEST(FreeportDevice, WhatIsWrittenShowsInTheReadWindowButNotOverReadOnlyChannels) {
  DeviceSetup setup = device_setup(5);
  setup.spec.channels = {test::channel("level", "window:0", ValueType::kUint16),
                         test::channel("lamp", "window:3.1", ValueType::kBool)};
  setup.spec.channels[1].access = Access::kReadWrite;
  auto made = make_freeport_device(setup);
  ASSERT_TRUE(made.has_value()) << made.error();
  auto& device = dynamic_cast<FreeportDevice&>(**made);
  const std::uint64_t level = device.memory().read(0, 1, test::kBegin);
  EXPECT_EQ(said(device, framed("R0504"
                                "00000002")),
            framed("00000002"));
  EXPECT_EQ(device.memory().read(0, 1, test::kBegin), level);
  EXPECT_EQ(device.memory().read(0, 3, test::kBegin), 2u);
  setup.spec.channels[0].at = "window:3";
  EXPECT_FALSE(make_freeport_device(setup).has_value());
}

}  // namespace
}  // namespace fieldcast::sim
