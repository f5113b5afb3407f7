// The forecast of responses of a whole bus in virtual time.
#include <gtest/gtest.h>

#include "tests/bus/plant.hpp"

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

TEST(ResponseForecast, ABusForecastsTheEndOfItsResponses) {
  VirtualBus bus(plant(2, 6, "refresh: 10ms, timeout: 100ms"), {}, 1);
  bus.run_until(Instant{1min});
  const LineFormat line{.baud = 19200, .data_bits = 8, .parity = Parity::kEven, .stop_bits = 1};
  const Duration whole = line.characters(8 + 27);  // a request, and the response of 11 registers
  Duration longest{};
  for (int step = 0; step < 2000; ++step) {
    bus.run_until(bus.now() + 200us);
    const Instant until = bus.engine().quiet_until();
    if (until != kLongAgo) longest = std::max(longest, until - bus.now());
  }
  EXPECT_GT(longest, whole) << "most responses are read when they are whole";
  EXPECT_LT(longest, 100ms);
}

// DF1 doubles a byte 10 of the transaction number and of the values, so that a response is longer
// than expected. It was refused as a response to another request, and not acknowledged.
TEST(ResponseForecast, AResponseWithDoubledBytesIsLongerAndRight) {
  const auto loaded = config::load_text(
      "bridge: test\nbuses:\n  - name: bus\n    port: { serial: /dev/none, baud: 19200 }\n"
      "    protocol: allen-bradley-df1\n    defaults: { refresh: 100ms }\n    devices:\n"
      "      - { name: plc, address: 1, channels: [ { name: c, at: \"N7:10\", type: uint16 } ] }\n",
      "plant.yaml", {});
  ASSERT_TRUE(loaded);
  VirtualBus bus(loaded->buses.front(), {}, 1);
  bus.run_until(Instant{2min});  // 1 200 requests: the number has a byte 10 in each 256th
  EXPECT_GT(bus.channels()[0].good, 1100u);
  EXPECT_EQ(bus.channels()[0].bad, 0u);
  EXPECT_LT(bus.channels()[0].longest_gap, 150ms);
}

}  // namespace
}  // namespace fieldcast::test
