#include "core/plan/layout/partition.hpp"

#include <algorithm>
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
  std::reverse(slices.begin(), slices.end());
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

}  // namespace fieldcast
