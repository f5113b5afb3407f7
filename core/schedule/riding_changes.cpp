// RidingScheduler: what changes while the wire runs, at once on the timetable in force, and the
// drafts of new plans.
#include <algorithm>

#include "core/schedule/riding_scheduler.hpp"

namespace fieldcast {

namespace {

std::int64_t ns(Instant instant) { return instant.time_since_epoch().count(); }

}  // namespace

template <typename Change>
void RidingScheduler::change_cost(DeviceIndex device, AreaIndex area, const Change& change) {
  bool read = false;  // anything there
  for (Strip& strip : layout_.strips) {
    if (strip.device != device || strip.area != area) continue;
    change(strip.cost);
    read = true;
  }
  if (!read) return;
  for (const ClusterIndex index : layout_.clusters_of[device]) {
    const Cluster& cluster = layout_.clusters[index];
    if (!cluster.list && layout_.strips[cluster.strip].area != area) continue;
    touch(cluster.begin);
  }
  stale_ = costs_changed_ = true;
}

void RidingScheduler::set_answer_time(DeviceIndex device, AreaIndex area, Duration answer_time) {
  // A list of ranges is of several areas: the one that was learned last stands for all.
  if (auto& list = layout_.lists[device]) list->set_answer_time(answer_time);
  change_cost(device, area, [&](ReadCost& cost) { cost.set_answer_time(answer_time); });
}

void RidingScheduler::set_longest(DeviceIndex device, AreaIndex area, std::uint32_t items) {
  batch_.clear();
  change_cost(device, area, [&](ReadCost& cost) { cost.set_longest(items); });
}

void RidingScheduler::set_point(PointIndex index, Duration refresh, Mode mode, Instant at) {
  const Place place = layout_.place_of[index];
  PointState& point = points_[place];
  const bool was_wanted = point.wanted();
  batch_.clear();
  point.refresh = std::max(point.least_refresh, refresh.count());
  point.mode = mode;
  set_period(point);
  if (begun_ && !was_wanted) {
    point.due = point.deadline = later(ns(at), point.period);
    point.eager = true;
  }
  touch(place);
  stale_ = true;
}

// The cluster at `place` has changed.
void RidingScheduler::touch(Place place) {
  changed_.push_back(layout_.cluster_at[place]);
  if (drafting_) touched_.push_back(place);
}

// Clusters with other refreshes or costs get turns on the timetable in force, until there is
// another. What is due stays due.
void RidingScheduler::settle_changes(std::int64_t now) {
  std::ranges::sort(changed_);
  changed_.erase(std::unique(changed_.begin(), changed_.end()), changed_.end());
  if (planner_ == Planner::kRiding) {
    for (const ClusterIndex cluster : changed_) table_.change(cluster, entry_of(cluster));
    table_.align();
    for (const ClusterIndex cluster : changed_) take_turns(cluster);
  }
  for (const ClusterIndex cluster : changed_) refresh_cluster(cluster, now);
  changed_.clear();
}

// Of a draft: a new plan after changes of refreshes, answer times or of what the wire really needs,
// if it makes a difference.
void RidingScheduler::make_plan() {
  constexpr double kMore = 1.02, kLess = 0.95;  // a new table costs the wire a round
  cut_ = costs_changed_ && cut_anew();
  planned_ = cut_;
  if (!cut_) {
    load_ = total_load(false);
    const double wanted = load_ * overrun_;
    const std::int64_t fastest = fastest_;
    find_fastest();
    const bool more = wanted > kFull && wanted > kMore * planned_for_;
    const bool ends = planned_for_ > kFull && wanted <= kFull;
    const bool less = ends || (stretch_ > 1 && wanted < kLess * planned_for_);
    planned_ = fastest != fastest_ || more || less;
  }
  if (planned_) plan();
}

// Cutting anew moves all turns, which costs the wire a round: only where a request has become much
// dearer or cheaper.
bool RidingScheduler::worth_cutting() {
  constexpr double kMuch = 0.3;
  std::vector<std::uint32_t> bridges;
  for (const Strip& strip : layout_.strips) bridges.push_back(strip.cost.bridge());
  bool much = cut_at_.empty();
  for (std::size_t i = 0; i < cut_at_.size(); ++i) {
    const double before = cut_at_[i], now = bridges[i];
    much = much || std::abs(now - before) > kMuch * std::max(1.0, before);
  }
  if (much) cut_at_ = std::move(bridges);
  return much;
}

// Answer times that were learned change what a request costs, and with it which neighbours are
// worth reading together. Whether there are other clusters now.
bool RidingScheduler::cut_anew() {
  if (planner_ == Planner::kOnePerChannel || !worth_cutting()) return false;
  const std::vector<Cluster> before = layout_.clusters;
  cut();
  return layout_.clusters != before;
}

void RidingScheduler::cut() {
  std::vector<Wanted> wanted;
  wanted.reserve(points_.size());
  for (const PointState& point : points_) wanted.push_back({point.first, point.end, false});
  std::vector<double> rates;
  if (planner_ == Planner::kRiding) {
    for (const PointState& point : points_)
      rates.push_back(1e9 / static_cast<double>(point.refresh));
  }
  cut_into_clusters(wanted, rates, layout_);
  clusters_.assign(layout_.clusters.size(), {});
}

}  // namespace fieldcast
