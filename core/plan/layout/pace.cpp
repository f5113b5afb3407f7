#include "core/plan/layout/pace.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace fieldcast {

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
  const double fastest = *std::max_element(rates.begin(), rates.end());
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
  std::reverse(slices.begin(), slices.end());
  return slices;
}

}  // namespace fieldcast
