// Tests discovery with one lost datagram: the first, the second, and so on to the last of a join.
// A station and its bridge must match in both directions in time after each loss.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "bridge/dds/transport/domain.hpp"
#include "tests/bridge/dds/dds_support.hpp"
#include "tools/bench/support/lossy_receive.hpp"

namespace fieldcast::testing {
namespace {

using std::chrono::duration;
using std::chrono::steady_clock;

constexpr double kLongestJoin = 3;             // seconds
constexpr std::uint32_t kMostDatagrams = 400;  // of one join

TEST(DiscoveryLoss, AJoinNeedsNoSingleDatagram) {
  const std::string bus = bus_name("one-lost");
  Obedient bridge(bus);
  double longest = 0;
  std::uint32_t number = 0;
  for (bool is_lost = true; is_lost && number < kMostDatagrams; ++number) {
    const std::uint64_t before = bench::lost_datagrams();
    bench::lose_one(number);
    const auto began = steady_clock::now();
    Domain station(loopback(), "station", nullptr);
    dds::DataWriter* commands =
        station.writer(kCommandTopic, command_writer_qos(std::chrono::seconds{5}), "station");
    dds::DataReader* results =
        station.reader(kCommandResultTopic, nullptr, dds::StatusMask::none());
    EXPECT_TRUE(eventually([&] {
      dds::PublicationMatchedStatus readers;
      dds::SubscriptionMatchedStatus writers;
      commands->get_publication_matched_status(readers);
      results->get_subscription_matched_status(writers);
      return readers.current_count == 1 && writers.current_count == 1;
    })) << "datagram "
        << number << " was lost";
    const double seconds = duration<double>(steady_clock::now() - began).count();
    EXPECT_LT(seconds, kLongestJoin) << "datagram " << number << " was lost";
    longest = std::max(longest, seconds);
    is_lost = bench::lost_datagrams() > before;
  }
  bench::lose_one(-1);
  std::printf("%u joins, the longest %.2f s\n", number, longest);
  EXPECT_GT(number, 1u);
}

}  // namespace
}  // namespace fieldcast::testing
