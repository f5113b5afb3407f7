#include <gtest/gtest.h>

#include "tests/bridge/dds/dds_support.hpp"

namespace fieldcast::testing {
namespace {

using namespace std::chrono_literals;

TEST(WriteOnlyChannel, AcquiredWhileNobodyReadIsGivenToTheFirstReader) {
  const std::string bus = bus_name("write-only");
  Received received;
  DdsLink link(loopback(), "test", received.handlers());
  BusSpec spec = bus_of(bus, 3);
  spec.devices[0].channels[1].access = Access::kWriteOnly;
  spec.devices[0].channels[2].access = Access::kWriteOnly;
  link.add_bus(spec);
  link.publish(bus, std::vector{good(0, 0.5), good(1, 1.5)}, both_clocks());

  Collected<StationSample> samples;
  Station station(loopback(), "late");
  station.subscribe_samples([&](const StationSample& sample) { samples.add(sample); }, {},
                            {.one_by_one = true});
  ASSERT_TRUE(eventually([&] { return samples.size() == 2; }))
      << samples.size() << " of the two channels that have a value came";
  link.publish(bus, std::vector{good(1, 2.5, 2)}, both_clocks());
  ASSERT_TRUE(eventually([&] { return samples.size() == 3; }));
  EXPECT_EQ(samples.all().back().channel, "c1");
  EXPECT_EQ(samples.all().back().value, Value{2.5});
}

}  // namespace
}  // namespace fieldcast::testing
