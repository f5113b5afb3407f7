#include "core/plan/layout/pack.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <tuple>
#include <utility>

#include "core/plan/layout/time_math.hpp"

namespace fieldcast {

namespace {

constexpr double kSpare = 1.2;  // more than the average, since slots are never quite equal

struct Piece {
  std::vector<PointIndex> points;
  Range range;
  Duration fastest = Duration::max();
};

// Cheapest split of the first points of an area.
struct Cut {
  double cost = std::numeric_limits<double>::max();  // nanoseconds of wire per second
  std::uint32_t from = 0;                            // first point of the last piece
  bool alone = false;                                // the last piece is a separate request
};

// An item, and the gap before it, are paid at the rate of its own point.
std::vector<Cut> cheapest_cuts(std::span<const Point> points, const AreaPoints& own,
                               const ListCost& list) {
  const auto count = static_cast<std::uint32_t>(own.points.size());
  const AreaIndex area = points[own.points.front()].range.area;
  const double item_ns = list.item_ns(area), begin_ns = ns(list.range_cost(area)) - item_ns;
  const double alone_ns = own.cost.item_ns();
  std::vector<Cut> best(count + 1);
  best[0].cost = 0;
  for (std::uint32_t begin = 0; begin < count; ++begin) {
    const Range& head = points[own.points[begin]].range;
    Range range{area, head.first, 0};
    double rate = 0, items = 0;  // rate of the fastest point; items read, each at its own rate
    bool listed = true;
    for (std::uint32_t last = begin; last < count; ++last) {
      const Point& point = points[own.points[last]];
      if (point.range.first > range.end() + own.cost.bridge()) break;
      listed = listed &&
               (last == begin || list.joins(range, area, point.range.first, point.range.end()));
      const std::uint32_t end = std::max(range.end(), point.range.end());
      rate = std::max(rate, 1 / to_seconds(point.refresh));
      items += (end - range.end()) / to_seconds(point.refresh);
      range.count = end - range.first;
      const bool single = own.cost.fits(range) || last == begin;
      if (!single && !listed) break;
      const auto offer = [&](double cost, bool alone) {
        if (cost < best[last + 1].cost) best[last + 1] = {cost, begin, alone};
      };
      if (listed) offer(best[begin].cost + begin_ns * rate + item_ns * items, false);
      if (!single) continue;
      const double request =
          static_cast<double>(own.cost.of_single(range).value_or(Duration{0}).count()) -
          alone_ns * range.count;
      offer(best[begin].cost + request * rate + alone_ns * items, true);
    }
  }
  return best;
}

std::vector<Piece> pieces_of(std::span<const Point> points, const AreaPoints& own,
                             const ListCost& list) {
  const std::vector<Cut> best = cheapest_cuts(points, own, list);
  std::vector<Piece> pieces;
  for (std::size_t end = own.points.size(); end > 0; end = best[end].from) {
    if (best[end].alone) continue;
    Piece piece{{}, points[own.points[best[end].from]].range};
    for (std::size_t i = best[end].from; i < end; ++i) {
      const Point& point = points[own.points[i]];
      piece.points.push_back(own.points[i]);
      piece.range.count = std::max(piece.range.end(), point.range.end()) - piece.range.first;
      piece.fastest = std::min(piece.fastest, point.refresh);
    }
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

// A point with n times the refresh of the fastest one joins every n-th read.
class AverageRead {
 public:
  AverageRead(std::span<const Point> points, const ListCost& cost) : points_(points), cost_(cost) {}

  // Returns false, without the piece, if the request would exceed a limit.
  bool add(const Piece& piece) {
    const Duration period = pack_.empty() ? piece.fastest : period_;
    auto& ranges = std::get<ReadRequest>(request_).ranges;
    const std::size_t size = ranges.size();
    double credit = credit_;
    for (const PointIndex index : piece.points) {
      const Point& point = points_[index];
      const double share = to_seconds(period) / to_seconds(point.refresh);
      credit += share >= 1 / kSpare ? 1.0 : share * kSpare;
      if (credit < 1) continue;
      credit -= 1;
      const Range& range = point.range;
      if (ranges.size() > size &&
          cost_.joins(ranges.back(), range.area, range.first, range.end())) {
        ranges.back().count = std::max(ranges.back().end(), range.end()) - ranges.back().first;
      } else {
        ranges.push_back(range);
      }
    }
    if (!pack_.empty() && ranges.size() > size && !cost_.of(request_)) {
      ranges.resize(size);
      return false;
    }
    credit_ = credit;
    period_ = period;
    pack_.insert(pack_.end(), piece.points.begin(), piece.points.end());
    return true;
  }
  [[nodiscard]] std::vector<PointIndex> finish() {
    std::get<ReadRequest>(request_).ranges.clear();
    credit_ = 0;
    return std::exchange(pack_, {});
  }

 private:
  std::span<const Point> points_;
  const ListCost& cost_;
  Request request_ = ReadRequest{};
  std::vector<PointIndex> pack_;
  Duration period_{};
  double credit_ = 0;
};

}  // namespace

std::vector<std::vector<PointIndex>> make_packs(std::span<const Point> points,
                                                std::span<const AreaPoints> areas,
                                                const ListCost& cost) {
  std::vector<Piece> pieces;
  for (const AreaPoints& area : areas) {
    std::vector<Piece> of_area = pieces_of(points, area, cost);
    std::move(of_area.begin(), of_area.end(), std::back_inserter(pieces));
  }
  std::ranges::stable_sort(pieces, [](const Piece& a, const Piece& b) {
    return std::tuple(a.fastest, a.range.area, a.range.first) <
           std::tuple(b.fastest, b.range.area, b.range.first);
  });
  std::vector<std::vector<PointIndex>> packs;
  AverageRead average(points, cost);
  for (const Piece& piece : pieces) {
    if (average.add(piece)) continue;
    packs.push_back(average.finish());
    (void)average.add(piece);
  }
  if (!pieces.empty()) packs.push_back(average.finish());
  for (auto& pack : packs) {
    std::ranges::sort(pack, [&](PointIndex a, PointIndex b) {
      const Range &p = points[a].range, &q = points[b].range;
      return std::tuple(p.area, p.first, p.end(), a) < std::tuple(q.area, q.first, q.end(), b);
    });
  }
  return packs;
}

}  // namespace fieldcast
