#include "core/plan/layout/partition.hpp"

#include <gtest/gtest.h>

#include <random>

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
