// Devices that respond at another baud rate, in virtual time: the wire garbles what one side sends
// at a rate at which the other does not receive.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/bus/virtual_bus.hpp"
#include "tests/support/declared_bus.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using test::VirtualBus;

constexpr std::string_view kChangingMeter = R"(
summary: a meter
addresses: { from: 1, to: 9 }
areas: [{ name: state, record: true }]
operations:
  - name: read
    read: state
    before:
      - request: [{ name: ask, constant: "/" }, { is: address }, { name: end, constant: "!" }]
        answer: [{ name: begin, constant: "/" },
                 { name: rate, is: rate, fill: 0x35, rates: { 0x30: 300, 0x35: 9600 } },
                 { name: end, constant: "!" }]
    request: [{ name: acknowledge, constant: 6 }, { is: rate }, { name: end, constant: "!" }]
    answer:
      - { name: begin, constant: 2 }
      - { name: text, is: value, text: 96 }
      - { name: energy, is: value, text: decimal(8) }
      - { is: checksum, kind: xor, of: begin..energy }
)";

tl::expected<BusSpec, std::string> meter_on(std::string_view port) {
  return test::loaded_bus("bridge: b\nbuses:\n  - name: bus\n    port: " + std::string(port) + R"(
    protocol: meter
    devices:
      - name: m
        address: 1
        channels: [{ name: energy, at: energy, type: uint32, refresh: 2s }]
)",
                          "meter", kChangingMeter);
}

TEST(ChangingRate, ARefreshIsKeptThatTheLineAloneCouldNotKeep) {
  const BusSpec spec = *meter_on("{ serial: /dev/ttyS0, baud: 300, format: 7E1 }");
  // The readout alone takes 3.5 s at 300 baud.
  VirtualBus bus(spec, {}, 1);
  bus.run_until(bus.now() + 200s);
  EXPECT_EQ(bus.channels()[0].quality, Quality::kGood);
  EXPECT_EQ(bus.channels()[0].bad, 0u);
  EXPECT_GE(bus.channels()[0].good, 98u);
  EXPECT_LE(bus.channels()[0].longest_gap, 2200ms);
}

TEST(ChangingRate, AfterAFailureTheLineHasItsOwnRateAgain) {
  sim::BusFaults faults;
  faults.devices["m"].loss = 0.2;
  faults.devices["m"].truncate = 0.1;
  VirtualBus bus(*meter_on("{ serial: /dev/ttyS0, baud: 300, format: 7E1 }"), faults, 3);
  bus.run_until(bus.now() + 600s);
  EXPECT_GE(bus.channels()[0].good, 150u);
}

TEST(ChangingRate, APortThatCannotChangeItsRateIsRefused) {
  for (const auto* port : {"{ tcp: 127.0.0.1:4001, baud: 300, format: 7E1 }",
                           "{ rfc2217: 127.0.0.1:4001, baud: 300, format: 7E1 }"}) {
    const auto spec = meter_on(port);
    ASSERT_FALSE(spec) << port;
    EXPECT_THAT(spec.error(), testing::HasSubstr("meter changes the baud rate of its line"));
    EXPECT_THAT(spec.error(), testing::HasSubstr("port: { serial: PATH }"));
  }
}

}  // namespace
}  // namespace fieldcast
