// Tests the state of a bus that a waiting member collects, over real DDS on loopback.
#include "bridge/dds/receivers/standby_follower.hpp"

#include <gtest/gtest.h>

#include "tests/bridge/dds/dds_support.hpp"

namespace fieldcast::testing {
namespace {

using namespace std::chrono_literals;

// Its next readings must have their own times, and times that increase.
TEST(StandbyFollower, ASampleOfAClockThatIsAheadIsNotAcquiredInTheFuture) {
  const BusSpec bus = bus_of(bus_name("followed"), 2);
  Received received;
  DdsLink master(loopback(), "master", received.handlers());
  Domain domain(loopback(), "waiting", nullptr);
  const StandbyFollower follower(domain, {bus}, {[](const std::string&, std::uint64_t) {}});
  master.add_bus(bus);
  const UtcMapping own = both_clocks();
  UtcMapping ahead = own;
  ahead.utc.nanoseconds += Duration{30s}.count();
  std::vector<Sample> samples{good(0, std::uint64_t{7}), good(1, std::uint64_t{8})};
  samples[1].acquired = own.instant - 40s;
  ASSERT_TRUE(eventually([&] {
    for (Sample& sample : samples) ++sample.sequence;
    master.publish(bus.name, samples, ahead);
    return follower.figures().front().blocks > 0;
  }));
  const UtcMapping now = both_clocks();
  const auto followed = follower.take(now).at(bus.name).state.samples;
  ASSERT_EQ(followed.size(), 2u);
  EXPECT_EQ(followed[0].value, samples[0].value);
  EXPECT_EQ(followed[0].acquired, now.instant);
  EXPECT_LT(followed[1].acquired, now.instant - 9s) << "its age";
  EXPECT_GT(followed[1].acquired, now.instant - 20s);
}

}  // namespace
}  // namespace fieldcast::testing
