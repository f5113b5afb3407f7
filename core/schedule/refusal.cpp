#include "core/schedule/refusal.hpp"

#include <algorithm>

namespace fieldcast {

void RefusalSearch::cut(std::span<PointState> points, std::span<const Place> refused,
                        std::int64_t now, std::int64_t forget) {
  const Place begin = refused.front(), end = refused.back() + 1;
  for (Node& node : open_) {
    if (begin >= node.begin && end <= node.end) node.half_refused = true;
  }
  const Place middle = refused[refused.size() / 2];
  points[middle].cut_until = later(now, forget);
  for (const Place place : refused) {
    if (points[place].wanted() && !points[place].bad) points[place].suspect = true;
  }
  if (open_.size() >= kMostOpen) open_.erase(open_.begin());
  open_.push_back({begin, middle, end});
}

void RefusalSearch::mark_bad(std::span<PointState> points, Place place, std::int64_t now,
                             std::int64_t forget) {
  for (Node& node : open_) {
    if (place >= node.begin && place < node.end) node.half_refused = true;
  }
  PointState& point = points[place];
  point.bad = true;
  point.suspect = false;
  point.eager = false;
  point.retry_at = later(now, forget);
}

void RefusalSearch::settle(std::span<PointState> points, Place begin, Place end) {
  const auto complete = [&](const Node& node) {
    if (node.end <= begin || node.begin >= end) return false;
    for (Place place = node.begin; place < node.end; ++place) {
      if (points[place].suspect && points[place].wanted()) return false;
    }
    if (node.half_refused) points[node.middle].cut_until = 0;
    return true;
  };
  std::erase_if(open_, complete);
}

}  // namespace fieldcast
