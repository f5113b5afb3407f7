#include "core/dispatch/refusal.hpp"

#include <algorithm>

namespace fieldcast {

void RefusalSearch::cut(std::span<PointState> points, std::span<const OrderIndex> refused,
                        Instant now, Duration forget) {
  const OrderIndex begin = refused.front(), end = refused.back() + 1;
  for (Node& node : open_) {
    if (begin >= node.begin && end <= node.end) node.half_refused = true;
  }
  const OrderIndex middle = refused[refused.size() / 2];
  points[middle].cut_until = later(now, forget);
  for (const OrderIndex index : refused) {
    if (points[index].wanted() && !points[index].bad) points[index].suspect = true;
  }
  if (open_.size() >= kMostOpen) open_.erase(open_.begin());
  open_.push_back({begin, middle, end});
}

void RefusalSearch::mark_bad(std::span<PointState> points, OrderIndex index, Instant now,
                             Duration forget) {
  for (Node& node : open_) {
    if (index >= node.begin && index < node.end) node.half_refused = true;
  }
  PointState& point = points[index];
  point.bad = true;
  point.suspect = false;
  point.eager = false;
  point.retry_at = later(now, forget);
}

void RefusalSearch::settle(std::span<PointState> points, OrderIndex begin, OrderIndex end) {
  const auto complete = [&](const Node& node) {
    if (node.end <= begin || node.begin >= end) return false;
    for (OrderIndex index = node.begin; index < node.end; ++index) {
      if (points[index].suspect && points[index].wanted()) return false;
    }
    if (node.half_refused) points[node.middle].cut_until = Instant{};
    return true;
  };
  std::erase_if(open_, complete);
}

}  // namespace fieldcast
