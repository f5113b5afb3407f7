#include "core/plan/layout/cost.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "core/plan/refresh.hpp"
#include "core/plan/shape/point_state.hpp"
#include "core/plan/wire_model.hpp"
#include "core/protocol/families/registry.hpp"
#include "tests/plan/fake_protocol.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using test::kFakeProtocol;

using test::kBits, test::kBytewise, test::kRegisters, test::kWindow;

const LineFormat kLine{9600, 8, Parity::kNone, 1};  // 10 bits: 1.0417 ms per character

DeviceTiming timing() {
  DeviceTiming device;
  device.protocol = &kFakeProtocol;
  device.response_time = 2ms;
  return device;
}

TEST(ReadCost, IsTheExactWireTimeOfEveryLength) {
  DeviceTiming device = timing();
  device.pause = 7ms;
  const ReadCost cost(device, kRegisters, kLine, 3ms, 125);
  for (std::uint32_t count : {1u, 2u, 60u, 125u}) {
    const Range range{kRegisters, 10, count};
    ASSERT_TRUE(cost.fits(range));
    EXPECT_EQ(cost.of(range), kLine.characters(13 + 2 * count) + 2ms + 3ms + 7ms) << count;
  }
  EXPECT_FALSE(cost.fits({kRegisters, 0, 126}));
}

TEST(ReadCost, BitsCostNothingWithinAByte) {
  const ReadCost cost(timing(), kBits, kLine, 3ms, 2000);
  EXPECT_EQ(cost.of({kBits, 0, 1}), cost.of({kBits, 3, 8}));
  EXPECT_EQ(cost.of({kBits, 0, 9}) - cost.of({kBits, 0, 8}),
            kLine.characters(14 + 1) - kLine.characters(14));
}

TEST(ReadCost, AlignedAreasAreReadByWholeUnits) {
  const ReadCost cost(timing(), kBytewise, kLine, 3ms, 100);
  EXPECT_EQ(cost.cover(13, 15), (Range{kBytewise, 8, 8}));
  EXPECT_EQ(cost.cover(7, 17), (Range{kBytewise, 0, 24}));
}

TEST(ReadCost, OnePointAcrossTwoUnitsIsReadable) {
  const ReadCost cost(timing(), kBytewise, kLine, 3ms, 2);
  EXPECT_TRUE(cost.of_single(cost.cover(7, 9)));
}

TEST(ReadCost, WindowsAreReadWhole) {
  const ReadCost cost(timing(), kWindow, kLine, 3ms, 1);
  EXPECT_EQ(cost.cover(20, 22), (Range{kWindow, 0, 64}));
  EXPECT_TRUE(cost.fits({kWindow, 0, 64}));
  EXPECT_EQ(cost.of({kWindow, 0, 64}), kLine.characters(13 + 64) + 5ms);
  EXPECT_EQ(cost.bridge(), 64u) << "one request for all of them";
}

TEST(ReadCost, AWindowStaysWholeWhateverWasLearned) {
  ReadCost cost(timing(), kWindow, kLine, 3ms, 1);
  cost.set_longest(10);
  EXPECT_EQ(cost.limit(), 64u);
  EXPECT_TRUE(cost.fits({kWindow, 0, 64}));
}

TEST(ReadCost, NoReadGoesFromOneBankToTheNext) {
  const auto protocol =
      *find_protocol("modbus-rtu")->make({.address = 1, .options = {}, .line = {}});
  DeviceTiming device = timing();
  device.protocol = protocol.get();
  constexpr AreaIndex kFiles = 4;
  const ReadCost cost(device, kFiles, kLine, 3ms, 10);
  EXPECT_TRUE(cost.of_single({kFiles, 9998, 2}));
  EXPECT_FALSE(cost.of_single({kFiles, 9999, 2}));
}

TEST(AllowedGap, IsNeverLessThanANanosecond) {
  EXPECT_EQ(allowed_gap_of(1000, 50ns), 950ns);
  EXPECT_EQ(allowed_gap_of(1000, 1s), 900ns) << "a tenth early at the most";
  EXPECT_EQ(allowed_gap_of(1, 0ns), 1ns);
  EXPECT_EQ(allowed_gap_of(0.2, 0ns), 1ns);
}

TEST(Later, NeverIsTheLatest) {
  EXPECT_EQ(later(Instant{1s}, 2s), Instant{3s});
  EXPECT_EQ(later(kNever - 1s, 2s), kNever);
  EXPECT_EQ(later(kNever, 1s), kNever);
}

TEST(ReadCost, BridgeEndsWhereAnotherRequestIsCheaper) {
  const ReadCost cost(timing(), kRegisters, kLine, 3ms, 125);
  const Duration one = cost.of({kRegisters, 0, 1});
  const std::uint32_t gap = cost.bridge();
  EXPECT_LE(cost.of({kRegisters, 0, gap + 2}), 2 * one);
  EXPECT_GT(cost.of({kRegisters, 0, gap + 3}), 2 * one);
}

// Eight bits are a character, so 18.54 ms of a second request are 142 bits. The range may end with
// seven bits of another byte.
TEST(ReadCost, ABridgeOfBitsThatAreReadByWholeBytesIsCountedInBits) {
  const ReadCost cost(timing(), kBytewise, kLine, 3ms, 512);
  ASSERT_EQ(kLine.characters(13) + 2ms + 3ms, 18541667ns);
  EXPECT_EQ(cost.bridge(), 142u + 7u);
}

TEST(ReadCost, SlowerDevicesBridgeMoreButNeverBeyondTheirLimit) {
  DeviceTiming device = timing();
  ReadCost cost(device, kRegisters, kLine, 3ms, 125);
  const std::uint32_t before = cost.bridge();
  cost.set_response_time(40ms);
  EXPECT_GT(cost.bridge(), before);
  device.max_gap = 4;
  ReadCost limited(device, kRegisters, kLine, 3ms, 125);
  limited.set_response_time(40ms);
  EXPECT_EQ(limited.bridge(), 4u);
}

TEST(ReadCost, DeviceLimitHoldsForBlocksAndNotForSinglePoints) {
  DeviceTiming device = timing();
  device.max_block = 8;
  const ReadCost cost(device, kRegisters, kLine, 3ms, 100);
  EXPECT_FALSE(cost.fits({kRegisters, 0, 9}));
  EXPECT_TRUE(cost.of_single({kRegisters, 0, 9}));
  EXPECT_FALSE(cost.of_single({kRegisters, 0, 126}));
}

// A read of one register has 15 characters. Points are ordered by device, area and address.
TEST(PlannedPoints, ARefreshBelowTheWireTimeOfItsReadIsRaisedToIt) {
  ScheduleInput input;
  input.line = kLine;
  input.silence = 3ms;
  for (const Duration response : {2ms, 200ms, 400ms, 600ms}) {
    input.devices.push_back(timing());
    input.devices.back().response_time = response;
  }
  const auto add = [&](DeviceIndex device, std::uint32_t first, Duration refresh) {
    input.points.push_back({.device = device, .range = {kRegisters, first, 1}, .refresh = refresh});
  };
  add(3, 7, 100ms);
  add(2, 5, 100ms);
  add(1, 2, 1s);
  add(1, 1, 100ms);
  add(0, 0, 100ms);
  const WireModel wire(input, Planner::kCyclic);
  std::vector<Duration> refreshes;
  for (const PlannedPoint& each : planned_points(input, wire.layout))
    refreshes.push_back(each.refresh);
  const Duration request = kLine.characters(15) + 3ms;
  EXPECT_EQ(refreshes,
            (std::vector<Duration>{100ms, request + 200ms, 1s, request + 400ms, request + 600ms}));
}

// A protocol that waits within its exchanges, and reads lists of up to four ranges.
struct PausingProtocol final : test::FakeProtocol {
  [[nodiscard]] const Traits& traits() const override { return lists_; }
  [[nodiscard]] std::optional<ExchangeSize> size(const Request& request) const override {
    const auto& ranges = std::get<ReadRequest>(request).ranges;
    ExchangeSize all{4, 4};
    for (const Range& range : ranges) {
      const auto one = FakeProtocol::size(ReadRequest{{range}});
      if (!one || ranges.size() > lists_.max_ranges) return std::nullopt;
      all.request_characters += 4;
      all.response_characters += one->response_characters;
    }
    all.rounds = 2;
    all.pauses = 11ms;
    return all;
  }
  Traits lists_{.name = "lists", .summary = "sizes only", .max_ranges = 4};
};
const PausingProtocol kPausing;

TEST(ReadCost, IncludesThePausesAndEachRoundOfTheExchange) {
  DeviceTiming device = timing();
  device.protocol = &kPausing;
  device.pause = 7ms;
  const ReadCost cost(device, kRegisters, kLine, 3ms, 125);
  EXPECT_EQ(cost.of({kRegisters, 10, 2}),
            kLine.characters(8 + 4 + 9) + 11ms + 2 * (2ms + 3ms) + 7ms);
}

TEST(ListCost, IncludesThePausesAndEachRoundOfTheExchange) {
  DeviceTiming device = timing();
  device.protocol = &kPausing;
  device.pause = 7ms;
  const ListCost cost(device, kLine, 3ms);
  const ReadRequest two{{{kRegisters, 10, 2}, {kRegisters, 90, 1}}};
  EXPECT_EQ(cost.of(two), kLine.characters(12 + 4 + 9 + 7) + 11ms + 2 * (2ms + 3ms) + 7ms);
  EXPECT_EQ(cost.of(ReadRequest{}), std::nullopt);
  EXPECT_EQ(cost.of(ReadRequest{std::vector<Range>(5, {kRegisters, 10, 2})}), std::nullopt);
}

TEST(ListCost, TheBlockOfTheDeviceLimitsTheItemsOfAList) {
  DeviceTiming device = timing();
  device.protocol = &kPausing;
  device.max_block = 4;
  const ListCost cost(device, kLine, 3ms);
  EXPECT_TRUE(cost.of(ReadRequest{{{kRegisters, 10, 2}, {kRegisters, 90, 2}}}));
  EXPECT_FALSE(cost.of(ReadRequest{{{kRegisters, 10, 2}, {kRegisters, 90, 3}}}));
  EXPECT_TRUE(cost.of(ReadRequest{{{kRegisters, 10, 5}}}, true)) << "one point that is longer";
}

TEST(ListCost, AreasThatAreReadByWholeUnitsAreNotInLists) {
  DeviceTiming device = timing();
  device.protocol = &kPausing;
  const ListCost cost(device, kLine, 3ms);
  EXPECT_TRUE(cost.lists(kRegisters));
  EXPECT_TRUE(cost.lists(kBits));
  EXPECT_FALSE(cost.lists(kBytewise));
  EXPECT_FALSE(cost.lists(kWindow));
}

PlannedPoint point(int priority, float elasticity = 1) {
  PlannedPoint made;
  made.priority = static_cast<std::int8_t>(priority);
  made.elasticity = elasticity;
  return made;
}

TEST(Stretch, OnePriorityIsStretchedAlike) {
  std::vector<PlannedPoint> points{point(0), point(0)};
  const Stretched stretched = stretch_points(points, 1.5);
  EXPECT_EQ(points[0].stretch, 1.5);
  EXPECT_EQ(points[1].stretch, 1.5);
  EXPECT_EQ(stretched.greatest, 1.5);
  EXPECT_EQ(stretched.priorities, 1u);
  EXPECT_FALSE(stretched.uneven);
}

TEST(Stretch, TheLowestPriorityGivesWayFirstAndNeverStarves) {
  std::vector<PlannedPoint> points{point(1), point(0), point(2)};
  stretch_points(points, 3);
  EXPECT_EQ(points[0].stretch, 1);
  EXPECT_EQ(points[1].stretch, 3);
  EXPECT_EQ(points[2].stretch, 1);
  stretch_points(points, 64);
  EXPECT_EQ(points[1].stretch, 64);
  EXPECT_EQ(points[0].stretch, 16);
  EXPECT_EQ(points[2].stretch, 4);
  EXPECT_EQ(points[1].stretch / points[2].stretch, kMostApart);
}

TEST(Stretch, ManyPrioritiesShareTheSameDistance) {
  std::vector<PlannedPoint> points{point(0), point(1), point(2), point(3), point(4)};
  stretch_points(points, 32);
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(points[i].stretch, 32 >> i);
  EXPECT_EQ(points[0].stretch / points[4].stretch, kMostApart);
}

TEST(Stretch, ElasticityIsTheShareOfTheStretch) {
  std::vector<PlannedPoint> points{point(0, 0.5F), point(0, 2)};
  const Stretched stretched = stretch_points(points, 2);
  EXPECT_EQ(points[0].stretch, 1.5);
  EXPECT_EQ(points[1].stretch, 3);
  EXPECT_EQ(stretched.least_elasticity, 0.5);
  EXPECT_TRUE(stretched.uneven);
}

TEST(Stretch, PointsThatAreNotReadDoNotCount) {
  std::vector<PlannedPoint> points{point(0), point(5, 3)};
  points[1].mode = Mode::kOnDemand;
  const Stretched stretched = stretch_points(points, 2);
  EXPECT_EQ(stretched.priorities, 1u);
  EXPECT_EQ(stretched.greatest, 2);
  EXPECT_FALSE(stretched.uneven);
}

TEST(Cycle, APointIsDueAtTheLastInstantWithinItsGap) {
  const Cycle cycle{Instant{100ns}, 90ns};
  EXPECT_EQ(due_after(cycle, Instant{190ns}, 100ns), Instant{280ns});
  EXPECT_EQ(due_after(cycle, Instant{185ns}, 100ns), Instant{280ns});
  EXPECT_EQ(due_after(cycle, Instant{190ns}, 1000ns), Instant{1180ns});
  EXPECT_EQ(due_after(cycle, Instant{130ns}, 100ns), Instant{230ns}) << "190 would be too soon";
  EXPECT_EQ(due_after(Cycle{}, Instant{130ns}, 100ns), Instant{230ns});
}

TEST(Cycle, PeriodsOfSlowerGroupsAreWholeBasePeriods) {
  EXPECT_EQ(cycle_period(1000ns, 1000ns, 0.06), 940ns);
  EXPECT_EQ(cycle_period(2000ns, 1000ns, 0.06), 1880ns);
  EXPECT_EQ(cycle_period(2500ns, 1000ns, 0.06), 1880ns);
  EXPECT_EQ(cycle_period(10'000ns, 1000ns, 0.06), 9400ns);
}

}  // namespace
}  // namespace fieldcast
