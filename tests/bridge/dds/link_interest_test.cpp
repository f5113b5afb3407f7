#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bridge/dds/topics/topics.hpp"
#include "tests/bridge/dds/dds_support.hpp"

namespace fieldcast::testing {
namespace {

using namespace std::chrono_literals;

TEST(DdsLink, InterestsAreReceivedAndEndWhenWithdrawnOrTheirStationGoes) {
  Received received;
  DdsLink link(loopback(), "test", received.handlers());
  const std::string name = bus_name("interested");
  auto station = std::make_unique<Station>(loopback(), name);
  station->declare_interest("a/*/*", 200ms);
  station->declare_interest("b/*/*", 300ms);
  const auto of = [&](const std::string& pattern) {
    std::vector<std::optional<Duration>> seen;
    for (const Interest& interest : received.interests.all()) {
      if (interest.station == name && interest.pattern == pattern) seen.push_back(interest.refresh);
    }
    return seen;
  };
  using Refreshes = std::vector<std::optional<Duration>>;
  ASSERT_TRUE(eventually(
      [&] { return of("a/*/*") == Refreshes{200ms} && of("b/*/*") == Refreshes{300ms}; }));
  station->withdraw_interest("a/*/*");
  EXPECT_TRUE(eventually([&] { return of("a/*/*") == Refreshes{200ms, std::nullopt}; }));
  station.reset();
  EXPECT_TRUE(eventually([&] {
    return of("b/*/*") == Refreshes{300ms, std::nullopt};
  })) << "the station has left";
}

// More than the reader holds, but no station exceeds its own limit.
TEST(DdsLink, AFloodOfInterestsIsRefusedWithALineAndTheBridgeGoesOn) {
  constexpr int kEach = 2500;
  Received received;
  DdsLink link(loopback(), "test", received.handlers());
  const std::string bus = bus_name("flooded");
  link.add_bus(bus_of(bus, 1));
  Station first(loopback(), bus_name("first")), second(loopback(), bus_name("second"));
  for (int i = 0; i < kEach; ++i) first.declare_interest("a/*/" + std::to_string(i), 200ms);
  ASSERT_TRUE(eventually([&] { return received.interests.size() == kEach; }))
      << received.interests.size();
  for (int i = 0; i < kEach; ++i) second.declare_interest("b/*/" + std::to_string(i), 200ms);
  EXPECT_TRUE(eventually(
      [&] { return received.problems.size() >= 1 && received.interests.size() >= kMaxInterests; }));
  EXPECT_EQ(received.interests.size(), static_cast<std::size_t>(kMaxInterests));
  std::string problems;
  for (const std::string& problem : received.problems.all()) problems += problem + '\n';
  EXPECT_THAT(problems, ::testing::HasSubstr("nterest"));
  EXPECT_LE(received.problems.size(), 5u) << problems;
  // Known interests still work: a withdrawn one makes room.
  first.withdraw_interest("a/*/0");
  EXPECT_TRUE(eventually(
      [&] { return received.interests.size() > static_cast<std::size_t>(kMaxInterests); }));
}

}  // namespace
}  // namespace fieldcast::testing
