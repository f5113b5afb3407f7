// RidingScheduler: what comes next in each cluster, and how long the wire may rest before it.
#include <algorithm>

#include "core/schedule/riding_scheduler.hpp"

namespace fieldcast {

namespace {
std::int64_t part(double share, std::int64_t of) {
  return static_cast<std::int64_t>(share * static_cast<double>(of));
}
}  // namespace

// Walks the next reads in the order in which they are due, as if the wire began now and did not
// rest: if the k-th ends S before it is due, the wire may rest S at most. A cluster that is read
// sooner than it is due is due sooner the next time.
RidingScheduler::Slack RidingScheduler::look_ahead(std::int64_t now) {
  const auto sooner = [](const Ahead& a, const Ahead& b) { return a.due > b.due; };
  const auto push = [&](const Ahead& ahead) {
    ahead_.push_back(ahead);
    std::push_heap(ahead_.begin(), ahead_.end(), sooner);
  };
  const ClusterIndex first = due_.top();
  const std::int64_t own = clusters_[first].agenda[0].cost;
  std::int64_t others = kNeverNs,
               end = now;  // slack of all but the first; end of the reads so far, without the first
  ahead_.clear();
  push({due_.top_key(), first, 0, 0});
  for (unsigned count = 0; count < weights_.look_ahead && !ahead_.empty(); ++count) {
    std::pop_heap(ahead_.begin(), ahead_.end(), sooner);
    const Ahead ahead = ahead_.back();
    ahead_.pop_back();
    if (ahead.due == kNeverNs) break;
    const auto& agenda = clusters_[ahead.cluster].agenda;
    std::int64_t early = 0;
    if (count > 0) {
      end = later(end, agenda[ahead.step].cost);
      others = std::min(others, ahead.due + silence_ - end);
      if (others <= own) break;
      early = std::max<std::int64_t>(0, ahead.due - later(end, others));
    }
    if (ahead.step + 1u < kAgenda) {
      const Coming& coming = agenda[ahead.step + 1];
      push({coming.again ? coming.due - early : coming.due, ahead.cluster, kNoSlot,
            (ahead.step + 1u) & 15u});
    }
    if (ahead.slot == kNoSlot) continue;
    for (std::size_t child = 2 * std::size_t{ahead.slot} + 1;
         child <= 2 * std::size_t{ahead.slot} + 2 && child < due_.size(); ++child) {
      push({due_.key(due_.at(child)), due_.at(child), static_cast<std::uint32_t>(child) & kNoSlot,
            0});
    }
  }
  const std::int64_t budget = std::min(others, due_.top_key() + silence_ - now);
  return {budget - own - reserve_, std::max(budget, own), budget <= own};
}

void RidingScheduler::refresh_cluster(ClusterIndex index, std::int64_t now) {
  ClusterState& cluster = clusters_[index];
  const auto points = points_of(index);
  take_out(index);
  if (suspended_until_[layout_.clusters[index].device] > now) return;
  std::int64_t due = kNeverNs, spare = kNeverNs, wake = kNeverNs;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const PointState& point = points[i];
    if (!point.wanted()) continue;
    if (point.retry_at > now) {
      wake = std::min(wake, point.retry_at);
      continue;
    }
    if (point.due < due) due = point.due, cluster.urgent = i;
    if ((point.eager || point.mode == Mode::kIntensive) && point.due < spare)
      spare = point.due, cluster.spare_urgent = i;
  }
  if (wake != kNeverNs) asleep_.put(index, wake);
  if (spare != kNeverNs) spare_.put(index, spare);
  if (due == kNeverNs) return;
  if (planner_ != Planner::kRiding) {
    due_.put(index, due);
    return write_agenda(index, now);
  }
  const PointState& head = points[cluster.urgent];
  const DeviceIndex device = layout_.clusters[index].device;
  const std::int64_t cost = shape(index, points, cluster.urgent, std::max(now, due), 0).cost;
  const std::int64_t until_answered = paces_[device].of(cost - tails_[device]);
  cluster.agenda[0] = {due, until_answered + tails_[device], false};
  // A turn is when the answer ends.
  const bool has_turn = !head.eager && head.lap > 0;
  const std::int64_t release =
      due - until_answered - (has_turn ? 0 : tails_[device]) - room_of(index, head);
  if (release <= now ||
      head.mode == Mode::kIntensive) {  // the intensive ones let the wire never rest
    due_.put(index, due);
  } else {
    held_.put(index, release);
  }
}

// How much sooner than it is due a read may end. On the timetable: no more than its next one can do
// without; a read that comes sooner yet would have to come again.
std::int64_t RidingScheduler::room_of(ClusterIndex cluster, const PointState& head) const {
  constexpr double kNoTurn = 0.1;  // of the period, for those without a turn
  if (head.eager || head.lap == 0) return part(kNoTurn, head.period);
  return table_.room() * table_.request(cluster).beat;
}

void RidingScheduler::take_out(ClusterIndex cluster) {
  due_.remove(cluster);
  held_.remove(cluster);
  spare_.remove(cluster);
  asleep_.remove(cluster);
}

// Reads the cluster in imagination, each time at the last moment.
void RidingScheduler::write_agenda(ClusterIndex index, std::int64_t now) {
  ClusterState& cluster = clusters_[index];
  const auto points = points_of(index);
  imagined_.assign(points.begin(), points.end());
  std::uint32_t urgent = cluster.urgent;
  for (Coming& coming : cluster.agenda) {
    PointState& head = imagined_[urgent];
    const std::int64_t at = std::max(now, head.due);
    const Pick& pick = shape(index, imagined_, urgent, at, 0);
    coming = {head.due, pick.cost, head.again};
    for (const std::uint32_t i : pick.members) {
      renew(index, imagined_[i], at);
      imagined_[i].again = true;
    }
    for (std::uint32_t i = 0; i < imagined_.size(); ++i) {
      if (imagined_[i].ready(now) && imagined_[i].due < imagined_[urgent].due) urgent = i;
    }
  }
}

}  // namespace fieldcast
