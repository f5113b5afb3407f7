#include "core/plan/windows.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

namespace fieldcast {
namespace {

constexpr std::uint32_t kFrequent = 3, kSlots = 4;
constexpr Duration kGoal{300};

// Requests 0 .. 2 are the frequent ones, in this order; the others are sent before request `rank`.
struct Bus {
  std::vector<std::uint32_t> ranks{0, 1, 2, 1, 3};
  std::vector<std::vector<Duration>> costs;  // by request and slot

  explicit Bus(unsigned seed) {
    std::mt19937 random(seed);
    for (std::size_t i = 0; i < ranks.size(); ++i) {
      costs.emplace_back();
      for (std::uint32_t slot = 0; slot < kSlots; ++slot) costs.back().emplace_back(random() % 100);
    }
  }
  [[nodiscard]] Windows windows() const {
    Windows windows(kFrequent, kSlots, Duration{1000});
    windows.set_goal(kGoal);
    for (std::size_t i = 0; i < ranks.size(); ++i) {
      for (std::uint32_t slot = 0; slot < kSlots; ++slot)
        windows.change(ranks[i], slot, Duration{}, costs[i][slot]);
    }
    return windows;
  }
  // From the definition: a round holds the reads after its request, and those of the next slot up
  // to it.
  [[nodiscard]] std::vector<Duration> rounds() const {
    std::vector<Duration> rounds;
    for (std::uint32_t of = 0; of < kFrequent; ++of) {
      for (std::uint32_t slot = 0; slot < kSlots; ++slot) {
        Duration& round = rounds.emplace_back();
        for (std::size_t i = 0; i < ranks.size(); ++i)
          round += costs[i][ranks[i] > of ? slot : (slot + 1) % kSlots];
      }
    }
    return rounds;
  }
  [[nodiscard]] std::int64_t strain() const {
    std::int64_t sum = 0;
    for (const Duration round : rounds()) {
      const std::int64_t over = std::max(Duration::zero(), round - kGoal).count();
      sum += over * over;
    }
    return sum;
  }
};

TEST(Windows, StrainAndLongestAreThoseOfTheRounds) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Bus bus(seed);
    EXPECT_EQ(bus.windows().longest(), std::ranges::max(bus.rounds())) << seed;
    const std::vector<std::vector<Duration>> costs = bus.costs;
    for (auto& of_request : bus.costs) std::ranges::fill(of_request, Duration{});
    Windows windows = bus.windows();
    std::int64_t strain = 0;
    for (std::size_t i = 0; i < costs.size(); ++i) {
      for (std::uint32_t slot = 0; slot < kSlots; ++slot) {
        strain += windows.strain(bus.ranks[i], slot, Duration{}, costs[i][slot]);
        windows.change(bus.ranks[i], slot, Duration{}, costs[i][slot]);
      }
    }
    EXPECT_EQ(strain, Bus(seed).strain()) << seed;
  }
}

TEST(Windows, StrainOfAChangeIsWhatTheChangeAdds) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Bus bus(seed);
    Windows windows = bus.windows();
    const std::int64_t before = bus.strain();
    const Duration cost = bus.costs[3][2];
    const std::int64_t added = windows.strain(1, 2, cost, Duration{70});
    bus.costs[3][2] = Duration{70};
    windows.change(1, 2, cost, Duration{70});
    EXPECT_EQ(bus.strain() - before, added) << seed;
    EXPECT_EQ(windows, bus.windows()) << seed;
  }
}

TEST(Windows, StrainsOfANewReadAreThoseOfEveryRank) {
  const Windows windows = Bus(7).windows();
  std::vector<std::int64_t> sums(kFrequent + 1);
  windows.add_strains(3, Duration{60}, sums);
  for (std::uint32_t rank = 0; rank <= kFrequent; ++rank)
    EXPECT_EQ(sums[rank], windows.strain(rank, 3, Duration{}, Duration{60})) << rank;
}

TEST(Windows, ExchangeSwapsTwoFrequentRequests) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Bus bus(seed);
    Windows windows = bus.windows();
    const std::int64_t before = bus.strain();
    const std::int64_t added = windows.exchange(1, bus.costs[1], bus.costs[2]);
    std::swap(bus.costs[1], bus.costs[2]);
    EXPECT_EQ(bus.strain() - before, added) << seed;
    EXPECT_EQ(windows, bus.windows()) << seed;
  }
}

}  // namespace
}  // namespace fieldcast
