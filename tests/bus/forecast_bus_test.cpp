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

}  // namespace
}  // namespace fieldcast::test
