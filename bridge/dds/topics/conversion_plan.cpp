#include <algorithm>

#include "bridge/dds/topics/conversion.hpp"
#include "bridge/dds/topics/topics.hpp"

namespace fieldcast {
namespace {

constexpr std::size_t kMaxChannelsOfPoint = 64, kMaxPlanAreaText = 32;

void to_idl(const PlanReport::Point& point, idl::PlannedPoint& out) {
  out.area() = cut_text(point.area, kMaxPlanAreaText);
  out.first(point.first);
  out.count(point.count);
  for (const std::string& channel : point.channels) {
    if (out.channels().size() == kMaxChannelsOfPoint) break;
    out.channels().emplace_back(cut_text(channel, kMaxNameLength));
  }
  out.period(point.period.count());
  out.phase(point.phase.count());
  out.worst_gap(point.worst_gap.value_or(Duration::zero()).count());
  out.stretch(point.stretch);
}

PlanReport::Point from_idl(const idl::PlannedPoint& point) {
  PlanReport::Point out{.area = point.area().c_str(),
                        .first = point.first(),
                        .count = point.count(),
                        .period = Duration{point.period()},
                        .phase = Duration{point.phase()},
                        .stretch = point.stretch()};
  for (const auto& channel : point.channels()) out.channels.emplace_back(channel.c_str());
  if (point.worst_gap() != 0) out.worst_gap = Duration{point.worst_gap()};
  return out;
}

idl::PlannedGroup head_of(const PlanReport::Group& group, std::uint32_t number) {
  idl::PlannedGroup out;
  out.number(number);
  out.device() = cut_text(group.device, kMaxNameLength);
  out.list(group.list);
  out.period(group.period.count());
  out.phase(group.phase.count());
  out.slack(group.slack.count());
  out.load(group.load);
  return out;
}

class Parts {
 public:
  void add(const PlanReport::Group& group, std::uint32_t number) {
    std::size_t done = 0;
    do {
      if (parts_.empty() || parts_.back().groups().size() == kPlanGroupsPerBlock ||
          points_ == kPlanPointsPerBlock) {
        parts_.emplace_back();
        points_ = 0;
      }
      idl::PlannedGroup& entry = parts_.back().groups().emplace_back(head_of(group, number));
      const std::size_t end = std::min(group.points.size(), done + kPlanPointsPerBlock - points_);
      points_ += end - done;
      for (; done < end; ++done) to_idl(group.points[done], entry.points().emplace_back());
    } while (done < group.points.size());
  }
  std::vector<idl::ReadPlan> take() {
    if (parts_.empty()) parts_.emplace_back();
    if (parts_.size() > kMaxPlanBlocks) parts_.resize(kMaxPlanBlocks);
    return std::move(parts_);
  }

 private:
  std::vector<idl::ReadPlan> parts_;
  std::size_t points_ = 0;
};

}  // namespace

std::vector<idl::ReadPlan> to_idl(std::string_view bus, const PlanReport& plan,
                                  std::uint64_t number, UtcTime since) {
  Parts filled;
  std::uint32_t group = 0;
  for (const PlanReport::Group& one : plan.groups) filled.add(one, group++);
  std::vector<idl::ReadPlan> parts = filled.take();
  std::uint32_t block = 0;
  for (idl::ReadPlan& part : parts) {
    part.bus() = cut_text(bus, kMaxNameLength);
    part.block(block++);
    part.blocks(static_cast<std::uint32_t>(parts.size()));
    part.number(number);
    part.in_force_since(since.nanoseconds);
    part.load(plan.load);
    part.stretch(plan.stretch);
    part.slot(plan.slot.count());
    part.hyperperiod(plan.hyperperiod.count());
  }
  return parts;
}

void append(const idl::ReadPlan& part, PlanReport& plan) {
  plan.load = part.load();
  plan.stretch = part.stretch();
  plan.slot = Duration{part.slot()};
  plan.hyperperiod = Duration{part.hyperperiod()};
  for (const idl::PlannedGroup& group : part.groups()) {
    if (group.number() >= plan.groups.size()) {
      plan.groups.push_back({.device = group.device().c_str(),
                             .list = group.list(),
                             .period = Duration{group.period()},
                             .phase = Duration{group.phase()},
                             .slack = Duration{group.slack()},
                             .load = group.load()});
    }
    for (const idl::PlannedPoint& point : group.points())
      plan.groups.back().points.push_back(from_idl(point));
  }
}

}  // namespace fieldcast
