#include "core/schedule/riding_scheduler.hpp"

#include <algorithm>
#include <numeric>

namespace fieldcast {

namespace {

constexpr std::uint32_t kNoPlace = ~0u;
constexpr std::size_t kMostBatch = 20;  // blocks that kDynamicBlocks plans at a time

std::int64_t ns(Instant instant) { return instant.time_since_epoch().count(); }
Instant instant(std::int64_t at) { return at == kNeverNs ? kNever : Instant{Duration{at}}; }

Clustering clustering_of(Planner planner) {
  if (planner == Planner::kRiding) return Clustering::kLists;
  return planner == Planner::kOnePerChannel ? Clustering::kSinglePoints : Clustering::kSingleRanges;
}

bool one_period(std::span<const PointState> points) {
  return std::all_of(points.begin(), points.end(), [&](const PointState& p) {
    return p.mode == Mode::kIntensive && p.period == points.front().period;
  });
}

}  // namespace

RidingScheduler::RidingScheduler(const ScheduleInput& input, Planner planner, bool proven,
                                 const RidingWeights& weights)
    : planner_(planner),
      weights_(weights),
      lead_(input.lead.count()),
      silence_(input.silence.count()),
      paces_(input.devices.size()),
      layout_(make_layout(input, clustering_of(planner))),
      points_(input.points.size()),
      clusters_(layout_.clusters.size()),
      suspended_until_(input.devices.size(), 0),
      due_(clusters_.size()),
      spare_(clusters_.size()),
      asleep_(clusters_.size()),
      held_(clusters_.size()),
      suspended_(input.devices.size()) {
  for (Place place = 0; place < points_.size(); ++place) {
    const Point& from = input.points[layout_.point_at[place]];
    PointState& point = points_[place];
    point.first = from.range.first;
    point.end = from.range.end();
    point.area = from.range.area;
    point.mode = from.mode;
    point.priority = static_cast<std::int8_t>(std::clamp(from.priority, -100, 100));
    point.elasticity = static_cast<float>(std::clamp(from.elasticity, 0.1, 10.0));
    const ReadCost& cost = layout_.strips[layout_.strip_at[place]].cost;
    const auto alone = cost.of_single(cost.cover(point.first, point.end));
    point.readable = alone.has_value();
    // Nobody is asked for more often than the wire can carry it: an absurd wish would stretch
    // everybody else's.
    point.least_refresh = std::max<std::int64_t>(1, alone.value_or(Duration{1}).count());
    point.refresh = std::max(point.least_refresh, from.refresh.count());
  }
  for (const DeviceTiming& device : input.devices)
    tails_.push_back(input.silence.count() + device.pause.count());
  for (const Strip& strip : layout_.strips) cut_at_.push_back(strip.cost.bridge());
  plan();
  if (proven) prove();
  ways_.clear();
}

Decision RidingScheduler::next(Instant at) {
  const std::int64_t now = seen_ = ns(at);
  wake(now);
  if (rests_since_ < now) rested_ += now - rests_since_;
  Decision decision = decide(now);
  rests_since_ = std::holds_alternative<Rest>(decision) ? now : kNeverNs;
  asked_ = now;
  return decision;
}

// The other planners have no timetable: earliest due first, with a look ahead that says how long
// the wire may rest.
Decision RidingScheduler::decide_ahead(std::int64_t now) {
  if (due_.empty()) return Rest{instant(next_wake())};
  if (planner_ == Planner::kDynamicBlocks) return next_of_batch(now);
  const Slack free = look_ahead(now);
  const ClusterIndex first = due_.top();
  if (free.rest <= 0) return make_block(first, clusters_[first].urgent, now, 0);
  if (spare_.empty()) return Rest{instant(std::min(later(now, free.rest), next_wake()))};
  const ClusterIndex other = spare_.top();
  if (other != first) {
    Block block = make_block(other, clusters_[other].spare_urgent, now, free.rest);
    if (block.cost.count() <= free.rest) return block;
  }
  return make_block(first, clusters_[first].urgent, now, 0);
}

// By the timetable: of the reads that may begin, the one that is due first, unless it would keep
// one from its instant that is due before it. Wire time that nobody has a right to goes to those
// that have use for it.
Decision RidingScheduler::decide(std::int64_t now) {
  constexpr std::size_t kLook = 8;
  if (planner_ != Planner::kRiding) return decide_ahead(now);
  for (std::size_t slot = 0; slot < std::min(kLook, due_.size()); ++slot) {
    const ClusterIndex cluster = due_.at(slot);
    if (in_the_way(due_.key(cluster), later(now, clusters_[cluster].agenda[0].cost))) continue;
    return make_block(cluster, clusters_[cluster].urgent, now, 0);
  }
  const std::int64_t until = std::min(held_.empty() ? kNeverNs : held_.top_key(), next_wake());
  if (!spare_.empty()) {
    const ClusterIndex cluster = spare_.top();
    const std::int64_t free = held_.empty() ? kNeverNs : held_.top_key() - now;
    Block block = make_block(cluster, clusters_[cluster].spare_urgent, now, free);
    if (block.cost.count() <= free) return block;
  }
  return Rest{instant(until)};
}

// Whether a read that is due at `due` and ends at `end` delays one that begins before that end and
// is due sooner.
bool RidingScheduler::in_the_way(std::int64_t due, std::int64_t end) {
  walk_.assign(1, 0);
  while (!walk_.empty()) {
    const std::size_t slot = walk_.back();
    walk_.pop_back();
    if (slot >= held_.size() || held_.key(held_.at(slot)) >= end) continue;
    if (clusters_[held_.at(slot)].agenda[0].due < due) return true;
    walk_.push_back(2 * slot + 1);
    walk_.push_back(2 * slot + 2);
  }
  return false;
}

Duration RidingScheduler::slack(Instant at) {
  const std::int64_t now = ns(at);
  wake(now);
  if (planner_ == Planner::kRiding) {
    std::int64_t free = held_.empty() ? kNeverNs : held_.top_key() - now;
    if (!due_.empty())
      free = std::min(free, due_.top_key() - clusters_[due_.top()].agenda[0].cost - now);
    return free == kNeverNs ? Duration::max() : Duration{std::max<std::int64_t>(0, free)};
  }
  if (due_.empty()) return Duration::max();
  return Duration{std::max<std::int64_t>(0, look_ahead(now).rest)};
}

void RidingScheduler::wake(std::int64_t now) {
  if (!begun_) begin(now);
  if (!changed_.empty()) settle_changes(now);
  while (!suspended_.empty() && suspended_.top_key() <= now) {
    const auto device = static_cast<DeviceIndex>(suspended_.top());
    suspended_.remove(device);
    for (const ClusterIndex cluster : layout_.clusters_of[device]) {
      for (PointState& point : points_of(cluster)) {
        if (point.due <= now) postpone(point, now);
      }
      refresh_cluster(cluster, now);
    }
  }
  while (!held_.empty() && held_.top_key() <= now) {
    const ClusterIndex cluster = held_.top();
    held_.remove(cluster);
    due_.put(cluster, clusters_[cluster].agenda[0].due);
  }
  while (!asleep_.empty() && asleep_.top_key() <= now) {
    const ClusterIndex cluster = asleep_.top();
    asleep_.remove(cluster);
    for (PointState& point : points_of(cluster)) {
      if (point.bad && point.retry_at <= now) postpone(point, now);
    }
    refresh_cluster(cluster, now);
  }
}

std::int64_t RidingScheduler::next_wake() const {
  std::int64_t at = kNeverNs;
  if (!suspended_.empty()) at = std::min(at, suspended_.top_key());
  if (!asleep_.empty()) at = std::min(at, asleep_.top_key());
  return at;
}

Slice RidingScheduler::slice_of(ClusterIndex cluster, std::span<const PointState> points,
                                std::uint32_t urgent, std::int64_t now, std::int64_t budget) const {
  switch (planner_) {
    case Planner::kRiding:
      // On a wire that never rests, neighbours of one refresh go round together: the optimal
      // partition, always.
      if (points[urgent].mode == Mode::kIntensive && one_period(points))
        return whole_slice(points, urgent, cost_of(cluster), now);
      return riding_slice(points, urgent, cost_of(cluster), now,
                          Allowance{budget, clusters_[cluster].beat.spacing}, weights_);
    case Planner::kDynamicBlocks: return near_slice(points, urgent, cost_of(cluster), now);
    case Planner::kOnePerChannel: return {urgent, urgent + 1};
    case Planner::kFastestMember: break;
  }
  return whole_slice(points, urgent, cost_of(cluster), now);
}

const Pick& RidingScheduler::shape(ClusterIndex cluster, std::span<const PointState> points,
                                   std::uint32_t urgent, std::int64_t now, std::int64_t budget) {
  if (layout_.clusters[cluster].list) {
    if (points[urgent].mode == Mode::kIntensive && one_period(points)) {
      lists_.whole(points, urgent, list_cost_of(cluster), now, pick_);
    } else {
      lists_.riding(points, urgent, list_cost_of(cluster), now,
                    Allowance{budget, clusters_[cluster].beat.spacing}, weights_, pick_);
    }
    return pick_;
  }
  const Slice slice = slice_of(cluster, points, urgent, now, budget);
  const Range range = range_of(points, slice, cost_of(cluster));
  pick_.members.resize(slice.end - slice.begin);
  std::iota(pick_.members.begin(), pick_.members.end(), slice.begin);
  pick_.ranges().assign(1, range);
  pick_.cost = cost_of(cluster).of(range).count();
  return pick_;
}

Block RidingScheduler::make_block(ClusterIndex cluster, std::uint32_t urgent, std::int64_t now,
                                  std::int64_t budget) {
  const auto points = points_of(cluster);
  const Pick& pick = shape(cluster, points, urgent, now, budget);
  Block block;
  block.device = layout_.clusters[cluster].device;
  block.ranges = pick.ranges();
  block.cost = Duration{pick.cost};
  for (const std::uint32_t i : pick.members) {
    if (points[i].ready(now))
      block.points.push_back(layout_.point_at[layout_.clusters[cluster].begin + i]);
  }
  return block;
}

// The simple algorithm, for comparison: the most urgent clusters, each as a block, twenty at a
// time.
Decision RidingScheduler::next_of_batch(std::int64_t now) {
  if (batch_.empty()) {
    const Slack free = look_ahead(now);
    if (free.rest > 0 && spare_.empty())
      return Rest{instant(std::min(later(now, free.rest), next_wake()))};
    std::vector<std::pair<std::int64_t, ClusterIndex>> taken;
    std::int64_t end = now;
    while (!due_.empty() && taken.size() < kMostBatch) {
      const ClusterIndex cluster = due_.top();
      end = later(end, clusters_[cluster].agenda[0].cost);
      if (!taken.empty() && due_.top_key() - end > reserve_) break;
      taken.emplace_back(due_.top_key(), cluster);
      batch_.push_back(make_block(cluster, clusters_[cluster].urgent, now, 0));
      due_.remove(cluster);
    }
    for (const auto& [key, cluster] : taken) due_.put(cluster, key);
    std::reverse(batch_.begin(), batch_.end());
  }
  Block block = std::move(batch_.back());
  batch_.pop_back();
  return block;
}

std::int64_t RidingScheduler::next_due(ClusterIndex cluster, const PointState& point,
                                       std::int64_t acquired) const {
  const Beat& beat = clusters_[cluster].beat;
  if (point.mode == Mode::kIntensive || beat.spacing == 0) return later(acquired, point.period);
  if (point.lap == 0) return due_after(beat, acquired, point.period);
  // The last of its turns within the period.
  const std::int64_t latest = later(acquired, point.period);
  const std::int64_t past = ((latest - point.first_due) % point.lap + point.lap) % point.lap;
  return latest - past;
}

// A point that came along early keeps its turn; otherwise it gets its next one.
void RidingScheduler::renew(ClusterIndex cluster, PointState& point, std::int64_t at) const {
  const bool keeps = planner_ == Planner::kRiding && point.mode == Mode::kScheduled &&
                     !point.eager && !point.suspect;
  if (!keeps || point.used(at) >= weights_.keep) point.due = next_due(cluster, point, at);
  point.deadline = later(at, point.period);
}

// What failed waits its turn anew: half a period later it is due again, sooner if the wire would
// rest.
void RidingScheduler::postpone(PointState& point, std::int64_t from) const {
  point.due = point.deadline = later(from, point.period / 2);
  point.eager = true;
}

void RidingScheduler::refresh_clusters_of(const Block& block, std::int64_t now) {
  ClusterIndex last = ~0u;
  for (const PointIndex index : block.points) {
    const ClusterIndex cluster = layout_.cluster_at[layout_.place_of[index]];
    if (cluster != last) refresh_cluster(cluster, now);
    last = cluster;
  }
}

void RidingScheduler::acquired(const Block& block, Instant at) {
  const std::int64_t now = seen_ = ns(at);
  paces_[block.device].read(now - asked_, block.cost.count() - tails_[block.device]);
  Place low = kNoPlace, high = 0;
  for (const PointIndex index : block.points) {
    const Place place = layout_.place_of[index];
    PointState& point = points_[place];
    if (!point.eager)
      watch_lateness(now - point.deadline > point.period / 20,
                     now);  // moments late: the next frame has room
    renew(layout_.cluster_at[place], point, now);
    point.retry_at = 0;
    point.eager = point.bad = point.suspect = false;
    low = std::min(low, place);
    high = std::max(high, place + 1);
  }
  if (refusals_.searching() && low < high) refusals_.settle(points_, low, high);
  refresh_clusters_of(block, now);
}

void RidingScheduler::failed(const Block& block, Instant at, Instant retry_at) {
  batch_.clear();
  for (const PointIndex index : block.points) {
    PointState& point = points_[layout_.place_of[index]];
    point.retry_at = ns(retry_at);
    postpone(point, std::max(ns(at), ns(retry_at)));
  }
  refresh_clusters_of(block, ns(at));
}

std::vector<PointIndex> RidingScheduler::refused(const Block& block, Instant at, Duration forget) {
  const std::int64_t now = ns(at);
  std::vector<PointIndex> bad;
  batch_.clear();
  places_.clear();
  for (const PointIndex index : block.points) {
    const Place place = layout_.place_of[index];
    places_.push_back(place);
    points_[place].due = std::min(points_[place].due, now);
    points_[place].deadline = std::min(points_[place].deadline, now);
    points_[place].eager = true;  // a search is no lateness
  }
  if (places_.empty()) return bad;
  std::sort(places_.begin(), places_.end());
  if (places_.size() == 1) {
    refusals_.mark_bad(points_, places_.front(), now, forget.count());
    refusals_.settle(points_, places_.front(), places_.front() + 1);
    bad.push_back(block.points.front());
  } else {
    refusals_.cut(points_, places_, now, forget.count());
  }
  refresh_clusters_of(block, now);
  return bad;
}

void RidingScheduler::suspend(DeviceIndex device, Instant until) {
  batch_.clear();
  suspended_until_[device] = ns(until);
  suspended_.put(device, ns(until));
  for (const ClusterIndex cluster : layout_.clusters_of[device]) take_out(cluster);
}

void replan(Scheduler& scheduler, Instant now) {
  const auto draft = scheduler.draft();
  if (!draft) return;
  draft->make();
  scheduler.adopt(*draft, now);
}

std::unique_ptr<Scheduler> make_scheduler(const ScheduleInput& input, Planner planner) {
  return std::make_unique<RidingScheduler>(input, planner, true);
}

PlannedLoad planned_load_of(const ScheduleInput& input, Planner planner) {
  const RidingScheduler scheduler(input, planner, false);
  return {scheduler.planned_load(), scheduler.stretch()};
}

}  // namespace fieldcast
