#include "core/plan/layout/partition.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace fieldcast {

std::vector<Slice> optimal_partition(std::span<const Wanted> wanted, const ReadCost& cost) {
  constexpr std::int64_t kUnreached = std::numeric_limits<std::int64_t>::max();
  const std::size_t n = wanted.size();
  std::vector<std::int64_t> best(n + 1, kUnreached);  // least cost of the first k
  std::vector<std::uint32_t> from(n + 1, 0);          // start of their last block
  best[0] = 0;
  for (std::size_t begin = 0; begin < n; ++begin) {
    std::uint32_t end = wanted[begin].end;
    for (std::size_t last = begin; last < n; ++last) {
      if (last > begin) {
        // No longer block is better beyond a barrier, or beyond a gap that costs as much as another
        // request.
        if (wanted[last].barrier || wanted[last].first > end + cost.bridge()) break;
        end = std::max(end, wanted[last].end);
      }
      const Range range = cost.cover(wanted[begin].first, end);
      std::int64_t price = 0;
      if (cost.fits(range)) {
        price = cost.of(range).count();
      } else if (last > begin) {
        break;
      } else {
        price = cost.of_single(range).value_or(Duration{0}).count();
      }
      if (best[begin] + price < best[last + 1]) {
        best[last + 1] = best[begin] + price;
        from[last + 1] = static_cast<std::uint32_t>(begin);
      }
    }
  }
  std::vector<Slice> slices;
  for (auto end = static_cast<std::uint32_t>(n); end > 0; end = from[end])
    slices.push_back({from[end], end});
  std::ranges::reverse(slices);
  return slices;
}

Range range_of(std::span<const Wanted> wanted, Slice slice, const ReadCost& cost) {
  std::uint32_t end = 0;
  for (std::uint32_t i = slice.begin; i < slice.end; ++i) end = std::max(end, wanted[i].end);
  return cost.cover(wanted[slice.begin].first, end);
}

Duration cost_of(std::span<const Wanted> wanted, std::span<const Slice> slices,
                 const ReadCost& cost) {
  Duration sum{};
  for (const Slice slice : slices)
    sum += cost.of_single(range_of(wanted, slice, cost)).value_or(Duration{0});
  return sum;
}

namespace {

// Levels from the fastest rate to a thousandth of it; slower rates count as that.
constexpr int kLevels = 32;

class PacedReads {
 public:
  PacedReads(const ReadCost& cost, double fastest) : cost_(cost), fastest_(fastest) {}

  void add(const Wanted& point, double rate) {
    const double steps = std::log(fastest_ / rate) / std::log(1.25);
    Reach& reach =
        reach_[static_cast<std::size_t>(std::clamp(std::lround(steps), 0L, kLevels - 1L))];
    reach.first = std::min(reach.first, point.first);
    reach.end = std::max(reach.end, point.end);
    reach.rate = std::max(reach.rate, rate);
  }

  // Nanoseconds of the wire per second.
  [[nodiscard]] double spent() const {
    double sum = 0, before = 0;
    Reach all;
    for (const Reach& reach : reach_) {
      if (reach.end == 0) continue;
      all.first = std::min(all.first, reach.first);
      all.end = std::max(all.end, reach.end);
      const auto read = static_cast<double>(cost_.of(cost_.cover(all.first, all.end)).count());
      sum += (read - before) * reach.rate;
      before = read;
    }
    return sum;
  }

 private:
  struct Reach {
    std::uint32_t first = std::numeric_limits<std::uint32_t>::max(), end = 0;
    double rate = 0;
  };
  const ReadCost& cost_;
  double fastest_;
  std::array<Reach, kLevels> reach_{};
};

}  // namespace

std::vector<Slice> partition_by_pace(std::span<const Wanted> points, std::span<const double> rates,
                                     const ReadCost& cost) {
  if (points.empty()) return {};
  const auto size = static_cast<std::uint32_t>(points.size());
  const double fastest = *std::ranges::max_element(rates);
  // Adjacent points with the same rate always stay together.
  std::vector<std::uint32_t> runs;
  for (std::uint32_t i = 0; i < size; ++i) {
    if (i == 0 || rates[i] != rates[i - 1] || points[i].first > points[i - 1].end)
      runs.push_back(i);
  }
  const auto count = static_cast<std::uint32_t>(runs.size());
  runs.push_back(size);
  std::vector<double> least(count + 1, std::numeric_limits<double>::infinity());
  std::vector<std::uint32_t> from(count + 1, 0);
  least[0] = 0;
  for (std::uint32_t begin = 0; begin < count; ++begin) {
    PacedReads reads(cost, fastest);
    for (std::uint32_t end = begin + 1; end <= count; ++end) {
      for (std::uint32_t i = runs[end - 1]; i < runs[end]; ++i) reads.add(points[i], rates[i]);
      const double spent = least[begin] + reads.spent();
      if (spent < least[end]) least[end] = spent, from[end] = begin;
    }
  }
  std::vector<Slice> slices;
  for (std::uint32_t end = count; end > 0; end = from[end])
    slices.push_back({runs[from[end]], runs[end]});
  std::ranges::reverse(slices);
  return slices;
}

}  // namespace fieldcast
