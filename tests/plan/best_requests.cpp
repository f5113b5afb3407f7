#include "tests/plan/best_requests.hpp"

namespace fieldcast::test {

BestRequests best_requests(std::span<const Range> wanted, const ListCost& cost) {
  std::vector<Range> groups;
  for (const Range& range : wanted) {
    if (!groups.empty() && cost.joins(groups.back(), range.area, range.first, range.end())) {
      groups.back().count = std::max(groups.back().end(), range.end()) - groups.back().first;
    } else {
      groups.push_back(range);
    }
  }
  const std::size_t count = groups.size();
  std::vector<Duration> best(count + 1, Duration::max());
  std::vector<std::size_t> from(count + 1);
  std::vector<ReadRequest> last(count + 1);
  best[0] = Duration::zero();
  for (std::size_t begin = 0; begin < count; ++begin) {
    Request list = ReadRequest{}, whole = ReadRequest{{groups[begin]}};
    for (std::size_t end = begin + 1; end <= count; ++end) {
      std::get<ReadRequest>(list).ranges.push_back(groups[end - 1]);
      Range& over = std::get<ReadRequest>(whole).ranges.front();
      over.count = groups[end - 1].end() - over.first;
      const auto listed = cost.of(list), covered = cost.of(whole);
      if (!listed && !covered) break;
      const bool covers = covered && (!listed || *covered < *listed);
      const Duration sum = best[begin] + (covers ? *covered : *listed);
      if (sum >= best[end]) continue;
      best[end] = sum;
      from[end] = begin;
      last[end] = std::get<ReadRequest>(covers ? whole : list);
    }
  }
  BestRequests result{{}, best[count]};
  for (std::size_t end = count; end > 0; end = from[end])
    result.requests.push_back(std::move(last[end]));
  return result;
}

}  // namespace fieldcast::test
