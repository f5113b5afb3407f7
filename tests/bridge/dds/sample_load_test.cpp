#include "bridge/dds/receivers/sample_load.hpp"

#include <gtest/gtest.h>

#include "tests/bridge/dds/dds_support.hpp"

namespace fieldcast::testing {
namespace {

BridgeSpec of_channels(std::size_t channels, Duration refresh) {
  BridgeSpec spec;
  spec.buses.push_back(bus_of("line", channels, [refresh](std::size_t) { return refresh; }));
  return spec;
}

TEST(SampleLoad, FollowsChannelsAndTheirRefreshes) {
  using namespace std::chrono_literals;
  EXPECT_EQ(sample_load(of_channels(1000, 1s)), 35714u);
  EXPECT_EQ(sample_load(of_channels(1000, 100ms)), 357142u);
  BridgeSpec on_demand = of_channels(1000, 1s);
  for (ChannelSpec& channel : on_demand.buses[0].devices[0].channels)
    channel.mode = Mode::kOnDemand;
  EXPECT_EQ(sample_load(on_demand), 0u);
}

TEST(SampleLoad, ABoundBelowItIsSaid) {
  using namespace std::chrono_literals;
  BridgeSpec spec = of_channels(10'000, 100ms);
  EXPECT_EQ(rate_remark(spec), std::nullopt);
  spec.dds.max_rate = 4'000'000;
  EXPECT_EQ(rate_remark(spec), std::nullopt);
  spec.dds.max_rate = 500'000;
  EXPECT_EQ(rate_remark(spec).value_or(""),
            "max-rate: 500 kB/s, and the samples for one station are at least 3571 kB/s: values "
            "come late, and some never; a larger max-rate, or longer refreshes");
}

}  // namespace
}  // namespace fieldcast::testing
