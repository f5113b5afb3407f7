// RidingScheduler: loads, stretching and the beats of the clusters.
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

#include "core/schedule/riding_scheduler.hpp"

namespace fieldcast {

namespace {

constexpr double kFull = 1.0;            // planned load from which on refreshes are stretched
constexpr double kCrowded = 0.6;         // planned load from which on long blocks are cut short for the others' sake
constexpr double kMostPerPriority = 4;   // how far points of one priority are stretched before those of the next higher one are
constexpr double kMostApart = 16;        // how much further the lowest priority than the highest: nobody starves
constexpr double kSimpleReserve = 0.25;  // of the fastest period, for the planners that are there to be compared with

std::int64_t less_lead(double refresh, std::int64_t lead) {
  const auto whole = static_cast<std::int64_t>(std::min(refresh, 1e18));
  return std::max<std::int64_t>(1, whole - std::min(lead, whole / 10));
}

}  // namespace

void RidingScheduler::set_period(PointState& point) const {
  const std::int64_t before = point.period;
  point.period = less_lead(static_cast<double>(point.refresh) * point.stretch, lead_);
  if (point.due == kNeverNs) return;
  point.due += point.period - before;
  point.deadline += point.period - before;
}

// The load of one cluster if it were alone on the wire: its next reads, each made when it is due. Also finds the level of its
// reads.
double RidingScheduler::cluster_load(ClusterIndex index, bool stretched) {
  constexpr int kReads = 200;
  const auto points = points_of(index);
  imagined_.assign(points.begin(), points.end());
  std::int64_t longest = 0, own = kNeverNs;
  for (PointState& point : imagined_) {
    point.retry_at = 0;
    const double refresh = static_cast<double>(point.refresh) * (stretched ? point.stretch : 1.0);
    point.period = point.due = point.deadline = less_lead(refresh, lead_);
    if (!point.wanted()) continue;
    longest = std::max(longest, point.period);
    own = std::min(own, point.period);
  }
  if (longest == 0) return 0;
  const Beat beat = planner_ == Planner::kRiding ? Beat{0, beat_spacing(own, fastest_, margin())} : Beat{};
  std::int64_t now = 0, spent = 0, reads = 0;
  while (reads < kReads && now <= 2 * longest) {
    std::uint32_t urgent = 0;
    for (std::uint32_t i = 0; i < imagined_.size(); ++i) {
      const bool sooner = !imagined_[urgent].wanted() || imagined_[i].due < imagined_[urgent].due;
      if (imagined_[i].wanted() && sooner) urgent = i;
    }
    now = imagined_[urgent].due;
    const Pick& pick = shape(index, imagined_, urgent, now, allowance(beat.spacing, 0, 0));
    ++reads;
    spent += pick.cost;
    for (const std::uint32_t i : pick.members) imagined_[i].due = due_after(beat, now, imagined_[i].period);
  }
  clusters_[index].level = static_cast<std::int64_t>(weights_.level * static_cast<double>(spent) / static_cast<double>(reads));
  return static_cast<double>(spent) / static_cast<double>(now);
}

double RidingScheduler::total_load(bool stretched) {
  double sum = 0;
  for (ClusterIndex cluster = 0; cluster < clusters_.size(); ++cluster) {
    const double load = cluster_load(cluster, stretched);
    if (!stretched) clusters_[cluster].load = load;
    sum += load;
  }
  return sum;
}

void RidingScheduler::find_fastest() {
  std::int64_t fastest = kNeverNs;
  for (const PointState& point : points_) {
    if (point.wanted() && point.mode == Mode::kScheduled) {
      fastest = std::min(fastest, less_lead(static_cast<double>(point.refresh) * point.stretch, lead_));
    }
  }
  fastest_ = fastest == kNeverNs ? 1 : fastest;
}

// Overload is met by longer refreshes: those of the lowest priority first, each priority up to a factor before the next one gives
// way, then all. Within a priority each takes its share by its elasticity (Buttazzo, Lipari, Abeni: Elastic Task Model, 1998).
void RidingScheduler::stretch_by(double factor) {
  std::map<std::int8_t, std::size_t> rank;
  for (const PointState& point : points_) {
    if (point.wanted()) rank.try_emplace(point.priority, 0);
  }
  std::size_t step = 0;
  for (auto& [priority, place] : rank) place = step++;
  const double ranks = static_cast<double>(std::max<std::size_t>(rank.size(), 2));
  const double apart = std::min(kMostPerPriority, std::pow(kMostApart, 1 / (ranks - 1)));
  stretch_ = least_elasticity_ = 1;
  uneven_ = false;
  for (PointState& point : points_) {
    const auto found = rank.find(point.priority);
    const double less = found == rank.end() ? 1.0 : std::pow(apart, static_cast<double>(found->second));
    point.stretch = 1.0 + std::max(0.0, factor / less - 1.0) * point.elasticity;
    if (!point.wanted()) continue;
    stretch_ = std::max(stretch_, point.stretch);
    least_elasticity_ = std::min(least_elasticity_, static_cast<double>(point.elasticity));
    uneven_ = uneven_ || point.elasticity != 1.0F;
  }
  priorities_ = rank.size();
}

// Works out loads and the stretch from the refreshes wished.
void RidingScheduler::plan() {
  stretch_by(1);
  find_fastest();
  crowded_ = false;
  load_ = total_load(false);
  if (load_ > kCrowded && planner_ == Planner::kRiding) {
    crowded_ = true;
    load_ = total_load(false);
  }
  planned_for_ = load_ * overrun_;
  if (planned_for_ > kFull) {
    double enough = planned_for_ / kFull;
    if (priorities_ > 1 || uneven_) {
      double fails = uneven_ ? 1 : enough;
      if (uneven_) enough = 1 + (enough - 1) / least_elasticity_;
      enough *= kMostApart;
      for (int halving = 0; halving < 14; ++halving) {
        const double middle = std::sqrt(fails * enough);
        stretch_by(middle);
        find_fastest();
        (total_load(true) * overrun_ > kFull ? fails : enough) = middle;
      }
    }
    stretch_by(enough);
    find_fastest();
  }
  for (PointState& point : points_) set_period(point);
  set_reserve();
}

// A light bus can afford to read earlier, so that noise and retries find time that nobody needs; a full one cannot.
void RidingScheduler::set_reserve() {
  double share = crowded_ ? weights_.reserve : weights_.light_reserve;
  if (planner_ != Planner::kRiding) share = kSimpleReserve;
  reserve_ = static_cast<std::int64_t>(share * static_cast<double>(fastest_));
}

double RidingScheduler::margin() const { return crowded_ ? weights_.margin : weights_.margin + weights_.light_reserve; }

// Gives every cluster its beat, and the points that are slower than the beat their turns on it.
void RidingScheduler::spread(std::int64_t now) {
  if (planner_ != Planner::kRiding) return;
  Leveller leveller(beat_spacing(fastest_, fastest_, margin()));
  std::vector<ClusterIndex> order(clusters_.size());
  std::iota(order.begin(), order.end(), ClusterIndex{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](ClusterIndex a, ClusterIndex b) { return clusters_[a].load > clusters_[b].load; });
  for (const ClusterIndex index : order) spread_cluster(index, now, leveller);
}

void RidingScheduler::spread_cluster(ClusterIndex index, std::int64_t now, Leveller& leveller) {
  const auto points = points_of(index);
  std::int64_t own = kNeverNs;
  for (const PointState& point : points) {
    if (point.wanted() && point.mode == Mode::kScheduled) own = std::min(own, point.period);
  }
  Beat& beat = clusters_[index].beat;
  beat = {};
  if (own == kNeverNs) return;
  beat.spacing = beat_spacing(own, fastest_, margin());
  if (beat.spacing <= 0) return;

  // Neighbours of one period share their turns, so that they share the way; far ones take other turns, so that no read is long.
  struct Riders {
    double cost = 0;
    std::int64_t turn = 0;
  };
  const auto turns = [&](const PointState& point) { return std::max<std::int64_t>(1, point.period / beat.spacing); };
  const bool list = layout_.clusters[index].list;
  const auto group = [&](const PointState& point) {
    const std::uint32_t bridge = list ? list_cost_of(index).bridge(point.area) : cost_of(index).bridge();
    const std::uint32_t from = list ? 0 : points.front().first;
    return std::tuple(turns(point), point.area, (point.first - from) / std::max<std::uint32_t>(1, 2 * bridge));
  };
  std::map<std::tuple<std::int64_t, AreaIndex, std::uint32_t>, Riders> riders;
  double base = clusters_[index].load / stretch_ * static_cast<double>(beat.spacing);
  for (const PointState& point : points) {
    if (!point.wanted() || turns(point) <= 1) continue;
    const auto [rider, alone] = riders.try_emplace(group(point));
    const double item_ns = list ? list_cost_of(index).item_ns(point.area) : cost_of(index).item_ns();
    double items = item_ns * (point.end - point.first);
    if (list && alone) items += static_cast<double>(list_cost_of(index).range_ns(point.area)) - item_ns;
    rider->second.cost += items;
    base -= items / static_cast<double>(turns(point));
  }
  beat.offset = now + leveller.place(beat.spacing, static_cast<std::int64_t>(std::max(0.0, base)));
  for (auto& [key, entry] : riders) {
    entry.turn = leveller.place_on({beat.offset - now, beat.spacing}, std::get<0>(key), static_cast<std::int64_t>(entry.cost));
  }
  for (PointState& point : points) {
    if (!point.wanted()) continue;
    const auto found = riders.find(group(point));
    point.first_due = beat.offset + (found == riders.end() ? 0 : found->second.turn * beat.spacing);
  }
}

void RidingScheduler::begin(std::int64_t now) {
  begun_ = true;
  spread(now);
  for (PointState& point : points_) {
    point.deadline = later(now, point.period);
    point.due = planner_ == Planner::kRiding && point.mode == Mode::kScheduled ? std::min(point.first_due, point.deadline)
                                                                               : point.deadline;
  }
  for (ClusterIndex cluster = 0; cluster < clusters_.size(); ++cluster) refresh_cluster(cluster, now);
}

// After a change of refreshes, answer times or of what the wire really needs: a new plan, if it makes a difference. What is due
// stays due; the beats of the clusters follow with their next reads.
void RidingScheduler::replan(std::int64_t now) {
  constexpr double kDifference = 0.02;
  const double wanted = load_ * overrun_;
  const bool stretches = std::max(wanted, planned_for_) > kFull && std::abs(wanted - planned_for_) > kDifference * planned_for_;
  const std::int64_t fastest = fastest_;
  if (stretches) {
    plan();
  } else {
    find_fastest();
  }
  if (stretches || fastest != fastest_) {
    spread(now);
    for (ClusterIndex cluster = 0; cluster < clusters_.size(); ++cluster) refresh_cluster(cluster, now);
  } else {
    Leveller leveller(beat_spacing(fastest_, fastest_, margin()));
    for (const ClusterIndex cluster : changed_) {
      if (planner_ == Planner::kRiding) spread_cluster(cluster, now, leveller);
      refresh_cluster(cluster, now);
    }
  }
  set_reserve();
  changed_.clear();
  stale_ = false;
}

// Answer times that were learned change what a request costs, and with it which neighbours are worth reading together. Points keep
// their turns; only the clusters are cut anew.
void RidingScheduler::recut(std::int64_t now) {
  costs_changed_ = false;
  if (planner_ == Planner::kOnePerChannel) return;
  std::vector<Wanted> wanted;
  wanted.reserve(points_.size());
  for (const PointState& point : points_) wanted.push_back({point.first, point.end, false});
  const std::vector<Cluster> before = layout_.clusters;
  cut_into_clusters(wanted, layout_);
  if (layout_.clusters == before) return;
  const std::size_t count = layout_.clusters.size();
  clusters_.assign(count, {});
  due_ = deadline_ = spare_ = asleep_ = DueQueue(count);
  batch_.clear();
  changed_.clear();
  plan();
  spread(now);
  for (ClusterIndex cluster = 0; cluster < count; ++cluster) refresh_cluster(cluster, now);
}

// A wire that is slower than planned (retries, late answers) shows in points that come late although the wire never rests.
void RidingScheduler::watch_lateness(bool late, std::int64_t now) {
  constexpr std::uint32_t kWindow = 256;
  constexpr double kMostOverrun = 16, kRests = 0.02;
  if (watched_ == 0) window_began_ = now, rested_ = 0;
  late_ += late ? 1 : 0;
  if (++watched_ < kWindow) return;
  const double before = overrun_;
  const bool rests = static_cast<double>(rested_) > kRests * static_cast<double>(now - window_began_);
  if (late_ > kWindow / 20 && !rests) overrun_ = std::min(kMostOverrun, overrun_ * 1.05);
  if (late_ == 0 || rests) overrun_ = std::max(1.0, overrun_ * 0.99);
  stale_ = stale_ || overrun_ != before;
  late_ = watched_ = 0;
}

}  // namespace fieldcast
