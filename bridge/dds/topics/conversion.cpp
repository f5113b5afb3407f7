#include "bridge/dds/topics/conversion.hpp"

#include <algorithm>

#include "bridge/dds/topics/conversion_enums.hpp"
#include "bridge/dds/topics/topics.hpp"

namespace fieldcast {

namespace {

constexpr std::size_t kHostBytes = 64, kProcessBytes = 128, kAskerBytes = 128, kWhyBytes = 256;

}  // namespace

void to_idl(const StandbyMessage& message, idl::Standby& out) {
  const StandbyMember& member = message.member;
  out.group() = cut_text(message.group, kMaxNameLength);
  out.bridge() = cut_text(member.bridge, kMaxNameLength);
  out.host() = cut_text(message.host, kHostBytes);
  out.process() = cut_text(message.process, kProcessBytes);
  out.since(member.since);
  out.beat(member.beat);
  out.strength(member.strength);
  out.role(static_cast<idl::StandbyRole>(member.role));
  out.term(member.term);
  out.successor() = cut_text(member.successor, kMaxNameLength);
  out.configuration() = cut_text(member.configuration, kMaxNameLength);
  out.not_ready() = cut_text(member.not_ready, kWhyBytes);
  out.written(message.written);
  out.noted(message.noted);
  out.buses().clear();
  for (const StandbyBusFigures& figures : message.buses) {
    if (out.buses().size() == static_cast<std::size_t>(kMaxBuses)) return;
    idl::StandbyBus& bus = out.buses().emplace_back();
    bus.bus() = cut_text(figures.bus, kMaxNameLength);
    bus.epoch(figures.epoch);
    bus.blocks(figures.blocks);
  }
}

std::optional<StandbyMessage> from_idl(const idl::Standby& message) {
  if (message.role() < idl::StandbyRole::STANDBY_WAITING ||
      message.role() > idl::StandbyRole::STANDBY_LEFT)
    return std::nullopt;
  StandbyMessage told;
  told.group = message.group().c_str();
  told.host = message.host().c_str();
  told.process = message.process().c_str();
  told.member = {message.bridge().c_str(),
                 message.since(),
                 message.beat(),
                 message.strength(),
                 static_cast<StandbyRole>(message.role()),
                 message.term(),
                 message.successor().c_str(),
                 message.configuration().c_str(),
                 message.not_ready().c_str()};
  told.written = message.written();
  told.noted = message.noted();
  for (const idl::StandbyBus& bus : message.buses())
    told.buses.push_back({bus.bus().c_str(), bus.epoch(), bus.blocks()});
  return told;
}

void to_idl(const StandbyNote& note, idl::StandbyNote& out) {
  out.group() = cut_text(note.group, kMaxNameLength);
  out.bridge() = cut_text(note.bridge, kMaxNameLength);
  out.term(note.term);
  out.number(note.number);
  out.kind(to_idl(note.kind));
  out.bus() = cut_text(note.bus, kMaxNameLength);
  out.requester() = cut_text(note.requester, kAskerBytes);
  out.request_id(note.request_id);
}

StandbyNote from_idl(const idl::StandbyNote& note) {
  return {note.group().c_str(), note.bridge().c_str(), note.term(), note.number(),
          // An unknown kind of a later version is treated as kBegun, so that the command is not run
          // again.
          from_idl(note.kind()).value_or(StandbyNoteKind::kBegun), note.bus().c_str(),
          note.requester().c_str(), note.request_id()};
}

void to_idl(const StandbyRequest& request, idl::StandbyRequest& out) {
  out.group() = cut_text(request.group, kMaxNameLength);
  out.bridge() = cut_text(request.bridge, kMaxNameLength);
  out.by() = cut_text(request.by, kAskerBytes);
}

StandbyRequest from_idl(const idl::StandbyRequest& request) {
  return {request.group().c_str(), request.bridge().c_str(), request.by().c_str()};
}

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

void to_idl(const BridgeClaims& claims, idl::Bridge& out) {
  out.bridge() = cut_text(claims.bridge, kMaxNameLength);
  out.host() = cut_text(claims.host, 64);
  out.process() = cut_text(claims.process, 128);
  out.version() = FIELDCAST_VERSION;
  out.standby_group() = cut_text(claims.group, kMaxNameLength);
  out.strength(claims.strength);
  out.since(claims.since.nanoseconds);
  out.buses().clear();
  for (const auto& [name, claim] : claims.buses) {
    if (out.buses().size() == static_cast<std::size_t>(kMaxBuses)) return;
    idl::BridgeBus& bus = out.buses().emplace_back();
    bus.bus() = cut_text(name, kMaxNameLength);
    bus.since(claim.since.nanoseconds);
    bus.serving(claim.serving);
  }
}

BridgeClaims from_idl(const idl::Bridge& bridge) {
  BridgeClaims claims;
  claims.bridge = bridge.bridge().c_str();
  claims.host = bridge.host().c_str();
  claims.process = bridge.process().c_str();
  claims.since = {bridge.since()};
  claims.group = bridge.standby_group().c_str();
  claims.strength = bridge.strength();
  for (const idl::BridgeBus& bus : bridge.buses())
    claims.buses[bus.bus().c_str()] = {{bus.since()}, bus.serving()};
  return claims;
}

StationBridge station_bridge(const idl::Bridge& bridge) {
  StationBridge known;
  known.bridge = bridge.bridge().c_str();
  known.host = bridge.host().c_str();
  known.process = bridge.process().c_str();
  known.version = bridge.version().c_str();
  known.standby_group = bridge.standby_group().c_str();
  known.strength = bridge.strength();
  known.since = {bridge.since()};
  for (const idl::BridgeBus& bus : bridge.buses())
    known.buses.push_back({bus.bus().c_str(), {bus.since()}, bus.serving()});
  return known;
}

}  // namespace fieldcast
