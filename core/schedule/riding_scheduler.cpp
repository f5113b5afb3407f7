#include "core/schedule/riding_scheduler.hpp"

#include <algorithm>
#include <cassert>

namespace fieldcast {

namespace {

std::int64_t ns(Instant instant) { return instant.time_since_epoch().count(); }
Instant instant(std::int64_t at) { return at == kNeverNs ? kNever : Instant{Duration{at}}; }
std::int64_t sum(std::int64_t at, std::int64_t by) { return at >= kNeverNs - by ? kNeverNs : at + by; }

constexpr std::uint32_t kNoSlot = ~0u;  // a repetition: no place in the queue
constexpr std::size_t kLookAhead = 64;  // reads that the look ahead counts

}  // namespace

RidingScheduler::RidingScheduler(const ScheduleInput& input, Planner planner, const RidingWeights& weights)
    : planner_(planner),
      weights_(weights),
      lead_(input.lead.count()),
      silence_(input.silence.count()),
      layout_(make_layout(input, planner == Planner::kOnePerChannel ? Clustering::kSinglePoints : Clustering::kOptimal)),
      points_(input.points.size()),
      clusters_(layout_.clusters.size()),
      devices_(input.devices.size()),
      due_(clusters_.size()),
      spare_(clusters_.size()),
      asleep_(clusters_.size()),
      suspended_(devices_.size()) {
  for (std::size_t device = 0; device < devices_.size(); ++device) devices_[device].pause = input.devices[device].pause.count();
  for (Place place = 0; place < points_.size(); ++place) {
    const Point& from = input.points[layout_.point_at[place]];
    PointState& point = points_[place];
    point.first = from.range.first;
    point.end = from.range.end();
    point.mode = from.mode;
    point.priority = static_cast<std::int8_t>(std::clamp(from.priority, -100, 100));
    point.refresh = std::max<std::int64_t>(1, from.refresh.count());
    const ReadCost& cost = cost_of(layout_.cluster_at[place]);
    point.readable = cost.of_single(cost.cover(point.first, point.end)).has_value();
    set_period(point);
  }
  for (ClusterIndex cluster = 0; cluster < clusters_.size(); ++cluster) load_ += clusters_[cluster].load = cluster_load(cluster);
  set_stretch();
}

void RidingScheduler::begin(std::int64_t now) {
  begun_ = true;
  for (PointState& point : points_) point.due = sum(now, point.period);
  for (ClusterIndex cluster = 0; cluster < clusters_.size(); ++cluster) refresh_cluster(cluster, now);
}

void RidingScheduler::set_period(PointState& point) const {
  const auto stretched = static_cast<std::int64_t>(static_cast<double>(point.refresh) * stretch_);
  point.period = std::max<std::int64_t>(1, stretched - std::min(lead_, stretched / 10));
}

void RidingScheduler::set_stretch() {
  constexpr double kFull = 0.95;  // what blocks that cannot be interrupted leave of a wire
  stretch_ = std::max(1.0, load_ / kFull);
  for (PointState& point : points_) {
    const std::int64_t before = point.period;
    set_period(point);
    if (point.due != kNeverNs) point.due += point.period - before;
  }
  std::int64_t fastest = kNeverNs;
  for (const PointState& point : points_)
    if (point.wanted()) fastest = std::min(fastest, point.period);
  reserve_ = fastest == kNeverNs ? 0 : static_cast<std::int64_t>(weights_.reserve * static_cast<double>(fastest));
}

// The load of one cluster if it were alone on the wire: its next reads, each made when it is due.
double RidingScheduler::cluster_load(ClusterIndex cluster) const {
  constexpr int kReads = 200;
  const auto span = points_of(cluster);
  const ReadCost& cost = cost_of(cluster);
  std::vector<PointState> points(span.begin(), span.end());
  std::int64_t longest = 0;
  for (PointState& point : points) {
    point.retry_at = 0;
    point.period = point.refresh - std::min(lead_, point.refresh / 10);
    point.due = point.period;
    if (point.wanted()) longest = std::max(longest, point.period);
  }
  if (longest == 0) return 0;
  std::int64_t now = 0, spent = 0;
  for (int read = 0; read < kReads && now <= 2 * longest; ++read) {
    std::uint32_t urgent = 0;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      if (points[i].wanted() && (!points[urgent].wanted() || points[i].due < points[urgent].due)) urgent = i;
    }
    now = points[urgent].due;
    Slice slice{urgent, urgent + 1};
    if (planner_ == Planner::kRiding)
      slice = riding_slice(points, urgent, cost, now, 0, weights_);
    else if (planner_ != Planner::kOnePerChannel)
      slice = whole_slice(points, urgent, cost, now);
    const Range range = range_of(points, slice, cost);
    spent += cost.of_single(range).value_or(Duration{0}).count();
    for (PointState& point : points) {
      if (point.first >= range.first && point.end <= range.end()) point.due = now + point.period;
    }
  }
  return now > 0 ? static_cast<double>(spent) / static_cast<double>(now) : 0;
}

double RidingScheduler::planned_load() const { return load_; }

void RidingScheduler::refresh_cluster(ClusterIndex index, std::int64_t now) {
  ClusterState& cluster = clusters_[index];
  const auto points = points_of(index);
  std::int64_t due = kNeverNs, spare = kNeverNs, wake = kNeverNs;
  const DeviceIndex device = layout_.clusters[index].device;
  const bool suspended = devices_[device].suspended_until > now;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const PointState& point = points[i];
    if (!point.wanted() || suspended) continue;
    if (point.retry_at > now) {
      wake = std::min(wake, point.retry_at);
      continue;
    }
    if (point.due < due) due = point.due, cluster.urgent = i;
    if ((point.eager || point.mode == Mode::kIntensive) && point.due < spare) spare = point.due, cluster.spare_urgent = i;
  }
  wake == kNeverNs ? asleep_.remove(index) : asleep_.put(index, wake);
  spare == kNeverNs ? spare_.remove(index) : spare_.put(index, spare);
  if (due == kNeverNs) {
    due_.remove(index);
    return;
  }
  due_.put(index, due);
  write_agenda(index, now);
}

// Reads the cluster in imagination, each time at the last moment.
void RidingScheduler::write_agenda(ClusterIndex index, std::int64_t now) {
  ClusterState& cluster = clusters_[index];
  const ReadCost& cost = cost_of(index);
  const auto points = points_of(index);
  imagined_.assign(points.begin(), points.end());
  for (PointState& point : imagined_) point.suspect = false;  // here: read in imagination
  std::uint32_t urgent = cluster.urgent;
  for (Coming& coming : cluster.agenda) {
    const std::int64_t at = std::max(now, imagined_[urgent].due);
    const Slice slice = shape(index, imagined_, urgent, at, 0);
    coming = {imagined_[urgent].due, cost.of(range_of(imagined_, slice, cost)).count(), imagined_[urgent].suspect};
    for (std::uint32_t i = slice.begin; i < slice.end; ++i) {
      imagined_[i].due = sum(at, imagined_[i].period);
      imagined_[i].suspect = true;
    }
    for (std::uint32_t i = 0; i < imagined_.size(); ++i) {
      if (imagined_[i].ready(now) && imagined_[i].due < imagined_[urgent].due) urgent = i;
    }
  }
}

void RidingScheduler::wake(std::int64_t now) {
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

// Walks the next reads in the order of their deadlines as if each were made at the last moment: if the k-th must be complete at D
// and all up to it take C together, the first of them must begin at D - C.
RidingScheduler::Slack RidingScheduler::look_ahead(std::int64_t now) {
  const auto later = [](const Ahead& a, const Ahead& b) { return a.due > b.due; };
  const auto push = [&](const Ahead& ahead) {
    ahead_.push_back(ahead);
    std::push_heap(ahead_.begin(), ahead_.end(), later);
  };
  const ClusterIndex first = due_.top();
  const std::int64_t own = clusters_[first].agenda[0].cost;
  std::int64_t others = kNeverNs, end = now;
  ahead_.clear();
  push({due_.top_key(), first, 0, 0});
  for (std::size_t count = 0; count < static_cast<std::size_t>(weights_.ahead) && !ahead_.empty(); ++count) {
    std::pop_heap(ahead_.begin(), ahead_.end(), later);
    const Ahead ahead = ahead_.back();
    ahead_.pop_back();
    if (ahead.due == kNeverNs) break;
    const auto& agenda = clusters_[ahead.cluster].agenda;
    std::int64_t early = 0;  // how much sooner than at the last moment it will be read
    if (count > 0) {
      end += agenda[ahead.step].cost;
      others = std::min(others, ahead.due + silence_ - end);
      if (others <= own) break;
      early = std::max<std::int64_t>(0, ahead.due - sum(end, others));
    }
    if (ahead.step + 1 < kAgenda) {
      const Coming& coming = agenda[ahead.step + 1];
      push({coming.again ? coming.due - early : coming.due, ahead.cluster, kNoSlot, ahead.step + 1});
    }
    if (ahead.slot == kNoSlot) continue;
    for (std::size_t child = 2 * std::size_t{ahead.slot} + 1; child <= 2 * std::size_t{ahead.slot} + 2 && child < due_.size();
         ++child) {
      push({due_.key(due_.at(child)), due_.at(child), static_cast<std::uint32_t>(child), 0});
    }
  }
  const std::int64_t budget = std::min(others, due_.top_key() + silence_ - now);
  return {budget - own - reserve_, std::max(budget, own)};
}

Slice RidingScheduler::shape(ClusterIndex cluster, std::span<const PointState> points, std::uint32_t urgent, std::int64_t now,
                             std::int64_t budget) const {
  switch (planner_) {
    case Planner::kRiding: return riding_slice(points, urgent, cost_of(cluster), now, budget, weights_);
    case Planner::kOnePerChannel: return {urgent, urgent + 1};
    case Planner::kDynamicBlocks:
    case Planner::kFastestMember: break;
  }
  return whole_slice(points, urgent, cost_of(cluster), now);
}

Block RidingScheduler::make_block(ClusterIndex cluster, std::uint32_t urgent, std::int64_t now, std::int64_t budget) const {
  const auto points = points_of(cluster);
  const Slice slice = shape(cluster, points, urgent, now, budget);
  const Range range = range_of(points, slice, cost_of(cluster));
  Block block;
  block.device = layout_.clusters[cluster].device;
  block.ranges = {range};
  block.cost = cost_of(cluster).of(range);
  for (std::uint32_t i = slice.begin; i < slice.end; ++i) {
    if (points[i].ready(now)) block.points.push_back(layout_.point_at[layout_.clusters[cluster].begin + i]);
  }
  return block;
}

Decision RidingScheduler::next(Instant at) {
  const std::int64_t now = ns(at);
  if (!begun_) begin(now);
  wake(now);
  if (due_.empty()) return Rest{instant(next_wake())};
  const Slack free = look_ahead(now);
  const ClusterIndex first = due_.top();
  if (free.rest <= 0) return make_block(first, clusters_[first].urgent, now, free.budget);
  if (!spare_.empty()) {
    const ClusterIndex other = spare_.top();
    if (other == first || clusters_[other].agenda[0].cost > free.rest)
      return make_block(first, clusters_[first].urgent, now, free.budget);
    return make_block(other, clusters_[other].spare_urgent, now, free.rest);
  }
  return Rest{instant(std::min(sum(now, free.rest), next_wake()))};
}

Duration RidingScheduler::slack(Instant at) {
  const std::int64_t now = ns(at);
  if (!begun_) begin(now);
  wake(now);
  if (due_.empty()) return Duration::max();
  return Duration{std::max<std::int64_t>(0, look_ahead(now).rest)};
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
  const std::int64_t now = ns(at);
  Place low = kNoSlot, high = 0;
  for (const PointIndex index : block.points) {
    const Place place = layout_.place_of[index];
    PointState& point = points_[place];
    point.due = sum(now, point.period);
    point.retry_at = 0;
    point.eager = point.bad = point.suspect = false;
    low = std::min(low, place);
    high = std::max(high, place + 1);
  }
  if (refusals_.searching() && low < high) refusals_.settle(points_, low, high);
  refresh_clusters_of(block, now);
}

// What failed waits its turn anew: half a period later it is due again, sooner if the wire would rest.
void RidingScheduler::postpone(PointState& point, std::int64_t from) {
  point.due = sum(from, point.period / 2);
  point.eager = true;
}

void RidingScheduler::failed(const Block& block, Instant at, Instant retry_at) {
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
  Place low = kNoSlot, high = 0;
  for (const PointIndex index : block.points) {
    const Place place = layout_.place_of[index];
    low = std::min(low, place);
    high = std::max(high, place + 1);
    points_[place].due = std::min(points_[place].due, now);
  }
  if (low >= high) return bad;
  if (block.points.size() == 1) {
    refusals_.mark_bad(points_, layout_.place_of[block.points.front()], now, forget.count());
    refusals_.settle(points_, low, high);
    bad.push_back(block.points.front());
  } else {
    refusals_.cut(points_, low, high, now, forget.count());
  }
  refresh_clusters_of(block, now);
  return bad;
}

void RidingScheduler::suspend(DeviceIndex device, Instant until) {
  devices_[device].suspended_until = ns(until);
  suspended_.put(device, ns(until));
  for (const ClusterIndex cluster : layout_.clusters_of[device]) {
    due_.remove(cluster);
    spare_.remove(cluster);
    asleep_.remove(cluster);
  }
}

void RidingScheduler::set_answer_time(DeviceIndex device, Duration answer_time) {
  for (Strip& strip : layout_.strips) {
    if (strip.device == device) strip.cost.set_answer_time(answer_time);
  }
  for (const ClusterIndex cluster : layout_.clusters_of[device]) {
    load_ -= clusters_[cluster].load;
    load_ += clusters_[cluster].load = cluster_load(cluster);
  }
}

void RidingScheduler::set_point(PointIndex index, Duration refresh, Mode mode, Instant at) {
  const Place place = layout_.place_of[index];
  const ClusterIndex cluster = layout_.cluster_at[place];
  PointState& point = points_[place];
  const bool was_wanted = point.wanted();
  const std::int64_t before = point.period;
  point.refresh = std::max<std::int64_t>(1, refresh.count());
  point.mode = mode;
  set_period(point);
  load_ -= clusters_[cluster].load;
  load_ += clusters_[cluster].load = cluster_load(cluster);
  if (!begun_) return;
  if (was_wanted) {
    point.due += point.period - before;
  } else {
    point.due = sum(ns(at), point.period);
    point.eager = true;
  }
  refresh_cluster(cluster, ns(at));
}

std::string_view to_text(Planner planner) {
  switch (planner) {
    case Planner::kRiding: return "riding";
    case Planner::kDynamicBlocks: return "dynamic-blocks";
    case Planner::kFastestMember: return "fastest-member";
    case Planner::kOnePerChannel: return "one-per-channel";
  }
  return "?";
}

std::unique_ptr<Scheduler> make_scheduler(const ScheduleInput& input, Planner planner) {
  return std::make_unique<RidingScheduler>(input, planner);
}

}  // namespace fieldcast
