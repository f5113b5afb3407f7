#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <random>
#include <set>
#include <string>

#include "core/dispatch/scheduler.hpp"
#include "core/protocol/families/registry.hpp"
#include "core/schedule/prediction.hpp"
#include "tests/dispatch/virtual_wire.hpp"
#include "tests/plan/best_requests.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using test::Answer;
using test::VirtualWire;

struct Bus {
  std::unique_ptr<Protocol> protocol;
  ScheduleInput input;

  Bus(const char* name, unsigned devices, std::map<std::string, std::string> options = {}) {
    input.line = LineFormat{19200, 8, Parity::kEven, 1};
    protocol = *find_protocol(name)->make(
        {.address = 1, .options = std::move(options), .line = input.line});
    input.silence = 2ms;
    input.devices.assign(devices, {.protocol = protocol.get(), .response_time = 5ms});
  }
  PointIndex add(DeviceIndex device, const std::string& at, std::uint32_t items, Duration refresh,
                 Mode mode = Mode::kScheduled) {
    const auto parsed = protocol->parse_address(at);
    if (!parsed) throw std::runtime_error(at + ": " + parsed.error().what);
    input.points.push_back({device, {parsed->area, parsed->first, items}, refresh, mode});
    return static_cast<PointIndex>(input.points.size() - 1);
  }
};
Bus fins(unsigned devices) { return {"omron-hostlink", devices, {{"mode", "fins"}}}; }

Block first_block(const Bus& bus) {
  return std::get<Block>(make_scheduler(bus.input)->next(Instant{1s}));
}

Bus scattered_ppi(unsigned words, Mode mode = Mode::kScheduled) {
  Bus bus("s7-ppi", 1);
  for (unsigned i = 0; i < words; ++i) {
    if (i % 4 == 3)
      bus.add(0, "C" + std::to_string(3 * i), 1, 1s, mode);
    else
      bus.add(0, "VW" + std::to_string(100 * i), 2, 1s, mode);
  }
  return bus;
}

TEST(ListCost, MarginalsAreWhatThePaperSays) {
  const Bus ppi("s7-ppi", 1);
  const ListCost items(ppi.input.devices[0], ppi.input.line, ppi.input.silence);
  EXPECT_LE(std::abs((items.range_cost(0) - ppi.input.line.characters(12 + 4 + 2)).count()),
            2);  // item, data header, a byte and its fill byte
  EXPECT_NEAR(items.item_ns(0), static_cast<double>(ppi.input.line.characters(1).count()), 60'000);
  const Bus omron = fins(1);
  const ListCost words(omron.input.devices[0], omron.input.line, omron.input.silence);
  const AreaIndex dm = omron.protocol->parse_address("DM0")->area;
  EXPECT_LE(std::abs((words.range_cost(dm) - omron.input.line.characters(2 * (4 + 3))).count()),
            2);                     // in hexadecimal: position; area code and word
  EXPECT_EQ(words.bridge(dm), 0u);  // every word is listed
  const Bus dtc("dtc", 1);
  const ListCost groups(dtc.input.devices[0], dtc.input.line, dtc.input.silence);
  EXPECT_EQ(groups.bridge(dtc.protocol->parse_address("int16:0")->area),
            2u);  // five bytes per group, two per variable
}

TEST(Lists, ScatteredPointsOfSeveralAreasShareARequest) {
  const Bus bus = scattered_ppi(12);
  const Block block = first_block(bus);
  EXPECT_EQ(block.points.size(), 12u);
  EXPECT_EQ(block.ranges.size(), 12u);
  const ListCost cost(bus.input.devices[0], bus.input.line, bus.input.silence);
  EXPECT_EQ(block.cost, cost.of(ReadRequest{block.ranges}));
}

TEST(Lists, NoRequestIsLongerThanItsProtocolAllows) {
  const Bus bus = scattered_ppi(60, Mode::kIntensive);
  const auto scheduler = make_scheduler(bus.input);
  VirtualWire wire(bus.input, *scheduler);
  wire.check = [&](const Block& block) {
    EXPECT_TRUE(bus.protocol->size(ReadRequest{block.ranges}));
  };
  wire.run(20s);
  wire.forget_gaps();
  wire.run(60s);
  const double rounds = static_cast<double>(wire.seen(0).count);
  EXPECT_NEAR(static_cast<double>(wire.blocks()) / rounds, 4.0, 0.1);  // 60 ranges, 19 per request
}

TEST(Lists, FastPointIsNotMadeToCarryEverySlowOneEachTime) {
  Bus bus("dtc", 1);
  bus.add(0, "int16:7", 1, 200ms);
  for (unsigned i = 1; i <= 40; ++i) bus.add(0, "int16:" + std::to_string(100 * i), 1, 8s);
  const auto scheduler = make_scheduler(bus.input);
  VirtualWire wire(bus.input, *scheduler);
  wire.run(30s);
  wire.forget_gaps();
  wire.run(80s);
  EXPECT_EQ(wire.missed(), 0u);
  for (PointIndex point = 1; point <= 40; ++point) EXPECT_LE(wire.seen(point).count, 14u) << point;
  EXPECT_LE(wire.blocks(), wire.seen(0).count + 2);  // they have no separate requests
}

TEST(Lists, RunsOfWordsThatAListWouldNameOneByOneAreReadByARequestOfTheirOwn) {
  Bus bus = fins(1);
  for (unsigned i = 0; i < 60; ++i) bus.add(0, "DM" + std::to_string(i), 1, 5s);
  for (unsigned i = 0; i < 5; ++i) bus.add(0, "DM" + std::to_string(5000 + 400 * i), 1, 5s);
  const auto scheduler = make_scheduler(bus.input);
  VirtualWire wire(bus.input, *scheduler);
  std::set<std::size_t> sizes;
  wire.check = [&](const Block& block) {
    sizes.insert(block.ranges.size());
    if (block.ranges.size() == 1) { EXPECT_EQ(block.ranges[0].count, 60u); }
  };
  wire.run(60s);
  EXPECT_EQ(sizes, (std::set<std::size_t>{1, 5}));
  EXPECT_EQ(wire.missed(), 0u);
}

TEST(Lists, RangeNeverCrossesABank) {
  Bus bus = fins(1);
  bus.add(0, "E0_32766", 2, 1s);
  bus.add(0, "E1_0", 2, 1s);
  const auto scheduler = make_scheduler(bus.input);
  VirtualWire wire(bus.input, *scheduler);
  wire.check = [&](const Block& block) {
    EXPECT_TRUE(bus.protocol->size(ReadRequest{block.ranges}));
  };
  wire.run(10s);
  EXPECT_EQ(wire.missed(), 0u);
  EXPECT_GT(wire.seen(1).count, 5u);
}

// Only the area of files has lists; registers and objects keep a request for each range.
TEST(Lists, RecordsOfSeveralFilesShareARequest) {
  Bus bus("modbus-rtu", 1);
  for (unsigned i = 0; i < 40; ++i)
    bus.add(0, "file:" + std::to_string(3 + 7 * i) + ":" + std::to_string(9 * i), 2, 5s);
  bus.add(0, "file:3:9999", 1, 5s);
  bus.add(0, "file:4:0", 1, 5s);
  for (const char* other : {"holding:0", "holding:9000", "id:0", "id:5"}) bus.add(0, other, 1, 5s);
  const auto scheduler = make_scheduler(bus.input);
  VirtualWire wire(bus.input, *scheduler);
  std::size_t most = 0;
  wire.check = [&](const Block& block) {
    EXPECT_TRUE(bus.protocol->size(ReadRequest{block.ranges}));
    most = std::max(most, block.ranges.size());
  };
  wire.run(60s);
  EXPECT_EQ(wire.missed(), 0u);
  EXPECT_GE(most, 20u);
  EXPECT_LE(wire.blocks(), wire.seen(0).count * 7);  // 2 requests of files, 2 + 2 others, a spare
}

TEST(Lists, LimitOfTheDeviceCountsTheItemsOfAllRanges) {
  Bus bus("dtc", 1);
  for (unsigned i = 0; i < 30; ++i) bus.add(0, "int16:" + std::to_string(50 * i), 1, 2s);
  bus.add(0, "int16:9000", 12, 2s);  // longer than the limit, but indivisible
  bus.input.devices[0].max_block = 8;
  const auto scheduler = make_scheduler(bus.input);
  VirtualWire wire(bus.input, *scheduler);
  wire.check = [&](const Block& block) {
    std::uint32_t items = 0;
    for (const Range& range : block.ranges) items += range.count;
    EXPECT_TRUE(items <= 8 || block.points == std::vector<PointIndex>{30});
  };
  wire.run(20s);
  for (PointIndex point = 0; point <= 30; ++point) EXPECT_GT(wire.seen(point).count, 8u) << point;
}

TEST(Lists, BadPointsAreFoundByHalvesAndTheOthersKeepTheirRefresh) {
  const Bus bus = scattered_ppi(16);
  const std::set<PointIndex> holes{5, 6, 11};
  unsigned refused = 0;
  const auto scheduler = make_scheduler(bus.input);
  VirtualWire wire(bus.input, *scheduler);
  wire.device = [&](const Block& block) {
    for (const PointIndex point : block.points) {
      if (holes.contains(point)) return ++refused, Answer::kRefused;
    }
    return Answer::kGood;
  };
  wire.run(20s);
  EXPECT_EQ(std::set<PointIndex>(wire.bad.begin(), wire.bad.end()), holes);
  EXPECT_LE(refused, 20u);
  refused = 0;
  wire.forget_gaps();
  wire.run(60s);
  EXPECT_EQ(refused, 0u);
  EXPECT_EQ(wire.missed(), 0u);
  EXPECT_LE(wire.blocks(), 90u);  // the accepted ones of both halves share requests again
}

TEST(Lists, PointThatWasFoundBadIsTriedAgainAlone) {
  const Bus bus = scattered_ppi(16);
  const auto scheduler = make_scheduler(bus.input);
  VirtualWire wire(bus.input, *scheduler);
  wire.forget = 5s;
  bool mended = false;
  wire.device = [&](const Block& block) {
    const bool bad = std::find(block.points.begin(), block.points.end(), 6u) != block.points.end();
    return bad && !mended ? Answer::kRefused : Answer::kGood;
  };
  wire.run(60s);
  EXPECT_EQ(std::set<PointIndex>(wire.bad.begin(), wire.bad.end()), std::set<PointIndex>{6});
  EXPECT_GE(wire.bad.size(), 8u);
  EXPECT_EQ(wire.seen(6).count, 0u);
  mended = true;
  wire.run(20s);
  EXPECT_GT(wire.seen(6).count, 10u);
}

TEST(Lists, DeviceThatTakesFewerRangesIsAskedForFewer) {
  const Bus bus = scattered_ppi(16);
  unsigned refused = 0;
  const auto scheduler = make_scheduler(bus.input);
  VirtualWire wire(bus.input, *scheduler);
  wire.device = [&](const Block& block) {
    return block.ranges.size() > 5 ? (++refused, Answer::kRefused) : Answer::kGood;
  };
  wire.run(10s);
  EXPECT_TRUE(wire.bad.empty());
  refused = 0;
  wire.forget_gaps();
  wire.run(60s);
  EXPECT_EQ(refused, 0u);
  EXPECT_EQ(wire.missed(), 0u);
}

// A converter or pseudo-terminal may be faster than the rate. An early read still counts.
TEST(Lists, ALineThatIsFasterThanItsRateIsNotReadMoreOften) {
  for (const std::uint32_t baud : {9600u, 19200u}) {
    for (const double pace : {0.01, 0.3, 0.8, 1.0}) {
      Bus bus("dtc", 1);
      bus.input.line.baud = baud;
      for (unsigned i = 0; i < 50; ++i) bus.add(0, "int16:" + std::to_string(i), 1, 200ms);
      const Prediction prediction = predict(bus.input, {.remedies = false});
      const auto scheduler = make_scheduler(bus.input);
      VirtualWire wire(bus.input, *scheduler);
      wire.pace = pace;
      wire.run(5s);
      wire.forget_gaps();
      wire.run(60s);
      const double planned = static_cast<double>(prediction.reads) / to_seconds(prediction.horizon);
      EXPECT_LT(static_cast<double>(wire.blocks()) / 60, 1.1 * planned) << baud << ' ' << pace;
      if (!prediction.feasible) continue;
      EXPECT_EQ(wire.missed(), 0u) << baud << ' ' << pace;
    }
  }
}

class RandomLists : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(RandomLists, BlocksAreSoundAndWhatIsPredictedFeasibleMissesNothing) {
  std::mt19937_64 random(GetParam());
  const auto below = [&](std::uint64_t n) { return static_cast<unsigned>(random() % n); };
  const unsigned units = 1 + below(3), family = below(3);
  Bus bus = family == 0 ? Bus("s7-ppi", units) : family == 1 ? fins(units) : Bus("dtc", units);
  const char* const areas[3][2] = {{"VW", "MW"}, {"DM", "W"}, {"int16:", "int32:"}};
  constexpr std::array kRefreshes{200, 500, 700, 1000, 2000, 5000, 10'000};
  bool limited = false;
  for (DeviceIndex device = 0; device < units; ++device) {
    for (unsigned i = 0, at = 0; i < 40; ++i, at += 2 + below(below(4) == 0 ? 60 : 4)) {
      const bool second = below(4) == 0;
      const unsigned items = family == 0 ? 2 : 1 + below(2);
      bus.add(device,
              areas[family][second] + std::to_string(second ? at % (family == 0 ? 30 : 500) : at),
              items, std::chrono::milliseconds{kRefreshes[below(kRefreshes.size())]});
    }
    if (below(3) == 0)
      bus.input.devices[device].max_block = static_cast<std::uint16_t>(10 + below(30)),
      limited = true;
  }
  const double planned = make_scheduler(bus.input)->planned_load();
  for (Point& point : bus.input.points)
    point.refresh = from_seconds(to_seconds(point.refresh) * planned / 0.5);
  const Prediction prediction = predict(bus.input, {.remedies = false});
  EXPECT_TRUE(prediction.feasible || limited);
  const auto scheduler = make_scheduler(bus.input);
  VirtualWire wire(bus.input, *scheduler);
  wire.check = [&](const Block& block) {
    const auto size = bus.protocol->size(ReadRequest{block.ranges});
    ASSERT_TRUE(size);
    EXPECT_EQ(block.cost,
              wire_time(*size, bus.input.line, bus.input.silence, bus.input.devices[block.device]));
    EXPECT_EQ(std::set<PointIndex>(block.points.begin(), block.points.end()).size(),
              block.points.size());
    for (const PointIndex point : block.points) {
      const Point& wanted = bus.input.points[point];
      EXPECT_EQ(wanted.device, block.device);
      EXPECT_TRUE(std::any_of(block.ranges.begin(), block.ranges.end(), [&](const Range& range) {
        return range.area == wanted.range.area && range.first <= wanted.range.first &&
               wanted.range.end() <= range.end();
      }));
    }
  };
  wire.run(prediction.horizon);
  if (!prediction.feasible) return;
  EXPECT_EQ(wire.missed(), 0u);
  EXPECT_EQ(wire.overdue(), 0u);
  EXPECT_NEAR(wire.load(), prediction.load, 0.05 * prediction.load);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomLists, ::testing::Range<std::uint64_t>(1, 31));

}  // namespace
}  // namespace fieldcast
