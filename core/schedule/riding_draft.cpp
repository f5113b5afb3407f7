// RidingScheduler: drafts of plans. A plan goes into force when a rehearsal of it keeps every
// refresh: the scheduler itself, copied, on an ideal wire, from the state in which the plan finds
// it.
#include <algorithm>
#include <array>
#include <utility>

#include "core/schedule/riding_scheduler.hpp"

namespace fieldcast {

namespace {

constexpr std::uint64_t kMostReads = 20'000;  // of one rehearsal

std::int64_t ns(Instant instant) { return instant.time_since_epoch().count(); }

}  // namespace

// The last instant at which the point may be acquired, less what no rehearsal foresees.
std::int64_t RidingScheduler::latest_for(const PointState& point) const {
  constexpr std::int64_t kUnforeseen = 1'000'000;
  const std::int64_t lead = std::min(lead_, point.refresh / 10);
  return later(point.deadline, lead - std::min(lead / 2, kUnforeseen));
}

std::uint64_t RidingScheduler::late_in(const Block& block, std::int64_t acquired) const {
  std::uint64_t late = 0;
  for (const PointIndex index : block.points) {
    const PointState& point = points_[layout_.place_of[index]];
    const bool failed = point.eager && point.retry_at != 0;  // a plan is not to blame for it
    if (point.mode == Mode::kScheduled && !failed && acquired > latest_for(point)) ++late;
  }
  return late;
}

// The ideal wire is as fast as its rate says.
void RidingScheduler::forget_paces(std::int64_t now) {
  const bool paced = std::ranges::any_of(paces_, [](const auto& pace) { return pace.share() < 1; });
  paces_.assign(paces_.size(), {});
  if (!paced || !begun_) return;
  for (ClusterIndex cluster = 0; cluster < clusters_.size(); ++cluster)
    refresh_cluster(cluster, now);
}

// Reads on an ideal wire that is free at `now`, until every point has gone round twice; how many
// were late, counted up to `enough`. Of a copy: what it was is gone.
std::uint64_t RidingScheduler::rehearse(std::int64_t now, std::uint64_t enough) {
  std::int64_t longest = 0;
  for (const PointState& point : points_) {
    if (point.wanted() && point.mode == Mode::kScheduled) longest = std::max(longest, point.period);
  }
  const std::int64_t end = later(now, 2 * std::max(longest, table_.length()));
  std::uint64_t late = 0, reads = 0;
  forget_paces(now);
  while (now < end && reads < kMostReads && late < enough) {
    const Decision decision = next(Instant{Duration{now}});
    if (const auto* rest = std::get_if<Rest>(&decision)) {
      now = std::max(now + 1, ns(rest->until));
      continue;
    }
    const Block& block = std::get<Block>(decision);
    const std::int64_t answered = now + block.cost.count() - tails_[block.device];
    late += late_in(block, answered);
    acquired(block, Instant{Duration{answered}});
    now += block.cost.count();
    ++reads;
  }
  return late;
}

// Of a plan just made, before it began: takes another if it does not keep every refresh and the
// other does, or breaks fewer.
void RidingScheduler::prove() {
  constexpr std::int64_t kStart = 1'000'000'000;
  if (planner_ != Planner::kRiding || stretch_ > 1 || table_.empty()) return;
  const auto late_of = [&](const RidingScheduler& plan, std::uint64_t enough) {
    return RidingScheduler(plan).rehearse(kStart, enough);
  };
  std::uint64_t least = late_of(*this, kAnyNumber);
  Timetable best = table_;
  for (Timetable& way : std::exchange(ways_, {})) {
    if (least == 0) break;
    table_ = std::move(way);
    const std::uint64_t late = late_of(*this, least);
    if (late < least) least = late, best = table_;
  }
  table_ = std::move(best);
}

struct RidingScheduler::Draft final : PlanDraft {
  explicit Draft(const RidingScheduler& of) : plan(of) {}
  void make() override;
  void choose(const RidingScheduler& before);
  RidingScheduler plan;
  std::int64_t began = 0;  // of its table
};

// The plan in force stays, at the costs that were learned, unless it must go or another is proven
// better.
void RidingScheduler::Draft::make() {
  const RidingScheduler before = plan;
  began = before.seen_;
  plan.make_plan();
  if (plan.planner_ != Planner::kRiding) return;
  choose(before);
  plan.ways_.clear();
}

void RidingScheduler::Draft::choose(const RidingScheduler& before) {
  const std::int64_t now = before.seen_ + before.silence_;
  std::uint64_t least = kAnyNumber;
  const bool must = plan.planned_ && (before.stretch_ > 1 || before.fastest_ != plan.fastest_);
  if (plan.stretch_ > 1) return;
  if (!must) {
    least = RidingScheduler(before).rehearse(now, kAnyNumber);
    if (!plan.planned_) {
      if (least == 0) return;
      plan.cut();
      plan.cut_ = plan.layout_.clusters != before.layout_.clusters;
      plan.plan();
      if (plan.stretch_ > 1) return;
    }
  }
  const bool kept = least == 0;
  std::optional<Timetable> best;
  std::vector<Timetable> ways = std::exchange(plan.ways_, {});
  ways.insert(ways.begin(), plan.table_);
  const std::array<std::int64_t, 2> starts{before.table_began_, before.seen_};
  for (Timetable& way : ways) {
    plan.table_ = std::move(way);
    for (const std::int64_t start : starts) {
      RidingScheduler trial(before);
      trial.take(RidingScheduler(plan), start, before.seen_);
      const std::uint64_t late = trial.rehearse(now, kept ? 1 : least);
      if (late >= (kept ? 1 : least)) continue;
      least = late;
      began = start;
      best = plan.table_;
      if (late == 0) break;
    }
    if (best && least == 0) break;
  }
  plan.planned_ = best.has_value();
  if (best) plan.table_ = *std::move(best);
}

std::unique_ptr<PlanDraft> RidingScheduler::draft() {
  if (drafting_ || !stale_) return nullptr;
  auto draft = std::make_unique<Draft>(*this);
  stale_ = costs_changed_ = false;
  drafting_ = true;
  touched_.clear();
  return draft;
}

void RidingScheduler::adopt(PlanDraft& draft, Instant at) {
  auto& made = static_cast<Draft&>(draft);
  drafting_ = false;
  load_ = made.plan.load_;
  cut_at_ = std::move(made.plan.cut_at_);
  if (made.plan.planned_) take(std::move(made.plan), made.began, ns(at));
}

// Puts a plan in force whose table began at `began`. Clusters that changed while it was made find
// turns on it.
void RidingScheduler::take(RidingScheduler&& plan, std::int64_t began, std::int64_t now) {
  load_ = plan.load_;
  if (plan.cut_) {
    layout_.clusters = std::move(plan.layout_.clusters);
    layout_.cluster_at = std::move(plan.layout_.cluster_at);
    layout_.clusters_of = std::move(plan.layout_.clusters_of);
    clusters_.assign(layout_.clusters.size(), {});
    due_ = held_ = spare_ = asleep_ = DueQueue(clusters_.size());
    batch_.clear();
  }
  for (Place place = 0; place < points_.size(); ++place) {
    points_[place].stretch = plan.points_[place].stretch;
    set_period(points_[place]);
  }
  table_ = std::move(plan.table_);
  weights_ = plan.weights_;
  fit_ = plan.fit_;
  stretch_ = plan.stretch_;
  least_elasticity_ = plan.least_elasticity_;
  uneven_ = plan.uneven_;
  priorities_ = plan.priorities_;
  planned_for_ = plan.planned_for_;
  room_ = plan.room_;
  fastest_ = plan.fastest_;
  reserve_ = plan.reserve_;
  changed_.clear();
  for (const Place place : touched_) changed_.push_back(layout_.cluster_at[place]);
  if (!begun_) return;
  settle_changes(now);
  spread(began);
  settled_at_ = later(now, table_.length());
  find_turns(now);
  for (ClusterIndex cluster = 0; cluster < clusters_.size(); ++cluster)
    refresh_cluster(cluster, now);
}

// Points take the last of their turns within their period, as if they had always had them; those
// never read the first.
void RidingScheduler::find_turns(std::int64_t now) {
  if (planner_ != Planner::kRiding) return;
  const auto rest = [](std::int64_t span, std::int64_t lap) { return (span % lap + lap) % lap; };
  for (PointState& point : points_) {
    const bool searched = point.bad || point.suspect || (point.eager && point.retry_at != 0);
    if (!point.wanted() || point.lap == 0 || point.due == kNeverNs || searched) continue;
    point.due = point.eager ? std::min(point.deadline, now + rest(point.first_due - now, point.lap))
                            : point.deadline - rest(point.deadline - point.first_due, point.lap);
  }
}

}  // namespace fieldcast
