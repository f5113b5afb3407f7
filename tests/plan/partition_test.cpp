#include "core/plan/layout/partition.hpp"

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <limits>
#include <map>
#include <random>
#include <utility>

#include "tests/plan/fake_protocol.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

using test::kFakeProtocol;
const LineFormat kEvenLine{19200, 8, Parity::kEven, 1};

Duration brute_force(const std::vector<Wanted>& wanted, const ReadCost& cost,
                     std::uint32_t max_gap) {
  Duration best = Duration::max();
  for (std::uint32_t cuts = 0; cuts < 1u << (wanted.size() - 1); ++cuts) {
    Duration sum{};
    bool allowed = true;
    std::uint32_t begin = 0;
    for (std::uint32_t i = 1; i <= wanted.size() && allowed; ++i) {
      if (i < wanted.size() && (cuts >> (i - 1) & 1u) == 0) continue;
      std::uint32_t end = wanted[begin].end;
      for (std::uint32_t k = begin + 1; k < i; ++k) {
        allowed = allowed && !wanted[k].barrier &&
                  (wanted[k].first <= end || wanted[k].first - end <= max_gap);
        end = std::max(end, wanted[k].end);
      }
      const Range range = cost.cover(wanted[begin].first, end);
      allowed = allowed && (cost.fits(range) || i - begin == 1);
      if (allowed) sum += cost.of_single(range).value();
      begin = i;
    }
    if (allowed) best = std::min(best, sum);
  }
  return best;
}

TEST(Partition, EqualsTheBestOfAllPartitionsOnRandomLists) {
  std::mt19937_64 random(1);
  for (int round = 0; round < 400; ++round) {
    DeviceTiming device;
    device.protocol = &kFakeProtocol;
    device.response_time = Duration{random() % 8'000'000};
    if (random() % 2) device.max_block = static_cast<std::uint16_t>(4 + random() % 40);
    if (random() % 3 == 0) device.max_gap = static_cast<std::uint16_t>(random() % 6);
    const AreaIndex area = static_cast<AreaIndex>(random() % 3);
    std::vector<Wanted> wanted;
    std::uint32_t first = static_cast<std::uint32_t>(random() % 20);
    const std::size_t size = 1 + random() % 11;
    for (std::size_t i = 0; i < size; ++i) {
      // A value with its exponent is wide and holds others: {100, 104} and {101, 104}.
      const std::uint64_t length = random() % 5 == 0 ? 4 + random() % 12 : 1 + random() % 4;
      wanted.push_back({first, first + static_cast<std::uint32_t>(length), random() % 12 == 0});
      first += static_cast<std::uint32_t>(random() % 16);
    }
    const ReadCost cost(device, area, kEvenLine, 2ms, wanted.back().end + 24);
    const auto slices = optimal_partition(wanted, cost);
    std::uint32_t expected = 0;
    for (const Slice slice : slices) {
      EXPECT_EQ(slice.begin, expected);
      expected = slice.end;
    }
    EXPECT_EQ(expected, wanted.size());
    EXPECT_EQ(cost_of(wanted, slices, cost),
              brute_force(wanted, cost, device.max_gap.value_or(65535)))
        << "round " << round;
  }
}

// Wire time of one block whose slower points are read together with all faster ones.
double spent_on(const std::vector<Wanted>& points, const std::vector<double>& rates, Slice slice,
                const ReadCost& cost) {
  std::map<double, std::pair<std::uint32_t, std::uint32_t>, std::greater<>> reaches;
  for (std::uint32_t i = slice.begin; i < slice.end; ++i) {
    const auto [reach, added] =
        reaches.try_emplace(rates[i], std::pair(points[i].first, points[i].end));
    if (!added)
      reach->second = {std::min(reach->second.first, points[i].first),
                       std::max(reach->second.second, points[i].end)};
  }
  double sum = 0, before = 0;
  std::uint32_t first = ~0u, end = 0;
  for (const auto& [rate, reach] : reaches) {
    first = std::min(first, reach.first);
    end = std::max(end, reach.second);
    const auto read = static_cast<double>(cost.of(cost.cover(first, end)).count());
    sum += (read - before) * rate;
    before = read;
  }
  return sum;
}

TEST(PartitionByPace, SpendsTheLeastAndKeepsAdjacentPointsOfOneRateTogether) {
  std::mt19937_64 random(2);
  for (int round = 0; round < 300; ++round) {
    DeviceTiming device;
    device.protocol = &kFakeProtocol;
    device.response_time = Duration{random() % 8'000'000};
    std::vector<Wanted> points;
    std::vector<double> rates;
    std::vector<bool> joined;  // to the point before
    std::uint32_t first = 20;
    const std::size_t size = 1 + random() % 9;
    for (std::size_t i = 0; i < size; ++i) {
      const bool gap = random() % 3 == 0;
      if (gap) first += 1 + static_cast<std::uint32_t>(random() % 8);
      const std::uint64_t longest = first < 80 && random() % 3 == 0 ? 30 : 3;
      const auto end = first + 1 + static_cast<std::uint32_t>(random() % longest);
      points.push_back({first, end, false});
      rates.push_back(std::array{10.0, 1.0, 0.1}[random() % 3]);
      joined.push_back(i > 0 && !gap && rates[i] == rates[i - 1]);
      first = end;
    }
    const ReadCost cost(device, test::kRegisters, kEvenLine, 2ms, first);
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t cuts = 0; cuts < 1u << (size - 1); ++cuts) {
      double sum = 0;
      bool allowed = true;
      std::uint32_t begin = 0;
      for (std::uint32_t i = 1; i <= size; ++i) {
        if (i < size && (cuts >> (i - 1) & 1u) == 0) continue;
        allowed = allowed && (i == size || !joined[i]);
        sum += spent_on(points, rates, {begin, i}, cost);
        begin = i;
      }
      if (allowed) least = std::min(least, sum);
    }
    double spent = 0;
    std::uint32_t begin = 0;
    for (const Slice slice : partition_by_pace(points, rates, cost)) {
      EXPECT_EQ(slice.begin, begin);
      EXPECT_FALSE(joined[slice.begin]) << "round " << round;
      spent += spent_on(points, rates, slice, cost);
      begin = slice.end;
    }
    EXPECT_EQ(begin, size);
    EXPECT_NEAR(spent, least, 1e-6 * least) << "round " << round;
  }
  EXPECT_TRUE(
      partition_by_pace({}, {}, ReadCost({.protocol = &kFakeProtocol}, 0, kEvenLine, 2ms, 1))
          .empty());
}

TEST(Partition, NothingWantedMakesNoBlock) {
  DeviceTiming device;
  device.protocol = &kFakeProtocol;
  EXPECT_TRUE(optimal_partition({}, ReadCost(device, 0, kEvenLine, 2ms, 1)).empty());
}

TEST(Partition, TooLongRangeStandsAlone) {
  DeviceTiming device;
  device.protocol = &kFakeProtocol;
  device.max_block = 10;
  const std::vector<Wanted> wanted{{0, 2}, {2, 22}, {22, 24}};
  const ReadCost cost(device, 0, kEvenLine, 2ms, 24);
  EXPECT_EQ(optimal_partition(wanted, cost), (std::vector<Slice>{{0, 1}, {1, 2}, {2, 3}}));
}

}  // namespace
}  // namespace fieldcast
