// RidingScheduler: loads, stretching, the timetable and the beats of the clusters. Other plans
// later: riding_changes.cpp.
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

#include "core/schedule/riding_scheduler.hpp"

namespace fieldcast {

namespace {

constexpr double kLight =
    0.6;  // planned load up to which reads keep farthest from their last instant,
constexpr double kCrowded = 0.95;  // and from which on they come as close to it as they can
constexpr double kMostPerPriority =
    4;  // how far points of one priority are stretched before those of the next higher one are
constexpr double kMostApart =
    16;  // how much further the lowest priority than the highest: nobody starves
constexpr double kSimpleReserve =
    0.25;  // of the fastest period, for the planners that are there to be compared with

std::int64_t part(double share, std::int64_t of) {
  return static_cast<std::int64_t>(share * static_cast<double>(of));
}

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

// The load of one cluster if it were alone on the wire: its next reads, each made when it is due.
// Also finds the level of its reads.
double RidingScheduler::cluster_load(ClusterIndex index, bool stretched) {
  constexpr int kReads = 64;
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
  const Beat beat =
      planner_ == Planner::kRiding ? Beat{0, beat_spacing(own, fastest_, margin())} : Beat{};
  std::int64_t now = 0, spent = 0, reads = 0;
  while (reads < kReads && now <= 2 * longest) {
    std::uint32_t urgent = 0;
    for (std::uint32_t i = 0; i < imagined_.size(); ++i) {
      const bool sooner = !imagined_[urgent].wanted() || imagined_[i].due < imagined_[urgent].due;
      if (imagined_[i].wanted() && sooner) urgent = i;
    }
    now = imagined_[urgent].due;
    const Pick& pick = shape(index, imagined_, urgent, now, 0);
    ++reads;
    spent += pick.cost;
    for (const std::uint32_t i : pick.members)
      imagined_[i].due = due_after(beat, now, imagined_[i].period);
  }
  return static_cast<double>(spent) / static_cast<double>(now);
}

double RidingScheduler::total_load(bool stretched) {
  double sum = 0;
  for (ClusterIndex cluster = 0; cluster < clusters_.size(); ++cluster)
    sum += cluster_load(cluster, stretched);
  return sum;
}

void RidingScheduler::find_fastest() {
  std::int64_t fastest = kNeverNs;
  for (const PointState& point : points_) {
    if (point.wanted() && point.mode == Mode::kScheduled) {
      fastest =
          std::min(fastest, less_lead(static_cast<double>(point.refresh) * point.stretch, lead_));
    }
  }
  fastest_ = fastest == kNeverNs ? 1 : fastest;
}

// Overload is met by longer refreshes: those of the lowest priority first, each priority up to a
// factor before the next one gives way, then all. Within a priority each takes its share by its
// elasticity (Buttazzo, Lipari, Abeni: Elastic Task Model, 1998).
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
    const double less =
        found == rank.end() ? 1.0 : std::pow(apart, static_cast<double>(found->second));
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
  room_ = 1;
  load_ = total_load(false);
  if (load_ > kLight && planner_ == Planner::kRiding) {
    room_ = 0;
    load_ = total_load(false);
    room_ = std::clamp((kCrowded - load_) / (kCrowded - kLight), 0.0, 1.0);
    if (room_ > 0) load_ = total_load(false);
  }
  planned_for_ = load_ * overrun_;
  double enough = 1;
  if (planned_for_ > kFull) {
    enough = planned_for_ / kFull;
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
  fit_ = 1;
  if (planner_ == Planner::kRiding) fit(enough);
  reserve_ = part(kSimpleReserve, fastest_);
}

// Makes the timetable; its turns are whole frames, which takes more than refreshes as they are
// wished. If that is too much, all is stretched a little more.
void RidingScheduler::fit(double factor) {
  constexpr double kMost = 0.994;
  constexpr int kAttempts = 8;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    make_timetable();
    double rhythmic = 0;
    for (ClusterIndex index = 0; index < clusters_.size(); ++index) {
      if (!table_.request(index).members.empty()) rhythmic += cluster_load(index, true);
    }
    if (rhythmic > 0) fit_ = table_.load() / rhythmic;
    if (table_.load() * overrun_ <= kMost) return;
    factor *= 1.002 * table_.load() * overrun_ / kMost;
    stretch_by(factor);
    find_fastest();
    for (PointState& point : points_) set_period(point);
  }
}

// A light bus can afford to read earlier, so that noise and retries find time that nobody needs; a
// full one cannot.
double RidingScheduler::margin() const { return weights_.margin + room_ * weights_.light_reserve; }

// What the timetable must know of a cluster; no members if nothing of it has a rhythm.
TimetableRequest RidingScheduler::entry_of(ClusterIndex index) const {
  TimetableRequest request;
  const auto points = points_of(index);
  request.list = layout_.clusters[index].list;
  const double beat = static_cast<double>(beat_spacing(fastest_, fastest_, margin()));
  for (const PointState& point : points) {
    if (!point.wanted() || point.mode != Mode::kScheduled) continue;
    TimetableMember& member = request.members.emplace_back();
    member.first = point.first;
    member.end = point.end;
    member.fits = static_cast<double>(point.period) * (1 - margin()) / beat;
    if (request.list) {
      const ListCost& cost = list_cost_of(index);
      member.area = point.area;
      member.bridge = cost.bridge(point.area);
      member.range_ns = cost.range_ns(point.area);
      member.item_ns = cost.item_ns(point.area);
    } else {
      member.item_ns = cost_of(index).item_ns();
      member.range_ns = static_cast<std::int64_t>(member.item_ns);
    }
  }
  if (!request.members.empty())
    request.base = request.list ? list_cost_of(index).request_ns() : base_of(index);
  return request;
}

// Wire time of a read of the cluster besides that of its items.
std::int64_t RidingScheduler::base_of(ClusterIndex index) const {
  const PointState& point = points_of(index).front();
  const Range range = cost_of(index).cover(point.first, point.end);
  return cost_of(index).of(range).count() -
         static_cast<std::int64_t>(cost_of(index).item_ns() * range.count);
}

void RidingScheduler::make_timetable() {
  constexpr std::size_t kMany = 2000;  // points that are placed one by one only once
  table_ = Timetable(std::max<std::int64_t>(1, beat_spacing(fastest_, fastest_, margin())),
                     part(weights_.margin - weights_.give, fastest_));
  std::vector<TimetableRequest> requests;
  for (ClusterIndex index = 0; index < clusters_.size(); ++index)
    requests.push_back(entry_of(index));
  ways_ = table_.fill(std::move(requests), points_.size() > kMany ? 0 : weights_.rounds);
}

// Gives every cluster its beat, and the points that are slower than the beat their turns on it.
void RidingScheduler::spread(std::int64_t began) {
  if (planner_ != Planner::kRiding) return;
  table_began_ = began;
  for (ClusterIndex index = 0; index < clusters_.size(); ++index) take_turns(index);
}

void RidingScheduler::take_turns(ClusterIndex index) {
  const TimetableRequest& request = table_.request(index);
  Beat& beat = clusters_[index].beat;
  beat = {};
  if (request.members.empty()) return;
  beat.spacing = request.beat * table_.frame();
  // The table counts until the wire is free again; points are acquired before.
  const std::int64_t latest = request.latest - tails_[layout_.clusters[index].device];
  beat.offset = table_began_ + request.phase * table_.frame() + latest;
  auto member = request.members.begin();
  for (PointState& point : points_of(index)) {
    point.lap = 0;
    if (!point.wanted() || point.mode != Mode::kScheduled) continue;
    point.lap = member->lap * table_.frame();
    point.first_due = table_began_ + member->turn * table_.frame() + latest;
    ++member;
  }
}

void RidingScheduler::begin(std::int64_t now) {
  begun_ = true;
  spread(now);
  settled_at_ = later(now, table_.length());
  for (PointState& point : points_) {
    point.deadline = later(now, point.period);
    point.due = planner_ == Planner::kRiding && point.mode == Mode::kScheduled
                    ? std::min(point.first_due, point.deadline)
                    : point.deadline;
  }
  for (ClusterIndex cluster = 0; cluster < clusters_.size(); ++cluster)
    refresh_cluster(cluster, now);
}

// A wire that is slower than planned (retries, late answers) shows in points that come late
// although the wire never rests.
void RidingScheduler::watch_lateness(bool late, std::int64_t now) {
  constexpr std::uint32_t kWindow = 256;
  constexpr double kMostOverrun = 16, kRests = 0.02;
  if (now < settled_at_) return;
  if (watched_ == 0) window_began_ = now, rested_ = 0;
  late_ += late ? 1 : 0;
  if (++watched_ < kWindow) return;
  const double before = overrun_;
  const bool rests =
      static_cast<double>(rested_) > kRests * static_cast<double>(now - window_began_);
  if (late_ > kWindow / 20 && !rests) overrun_ = std::min(kMostOverrun, overrun_ * 1.05);
  if (late_ == 0 || rests) overrun_ = std::max(1.0, overrun_ * 0.99);
  stale_ = stale_ || overrun_ != before;
  late_ = watched_ = 0;
}

}  // namespace fieldcast
