#include "bridge/station/plan_parts.hpp"

namespace fieldcast {

std::optional<StationReadPlan> PlanParts::on_part(const idl::ReadPlan& part) {
  if (part.blocks() > kMaxPlanBlocks || part.block() >= part.blocks()) return std::nullopt;
  Plan& plan = buses_[part.bus().c_str()];
  if (part.number() < plan.number) return std::nullopt;
  if (part.number() > plan.number) plan = {part.number(), {}};
  plan.parts.insert_or_assign(part.block(), part);
  if (plan.parts.size() < part.blocks()) return std::nullopt;
  StationReadPlan whole{.bus = part.bus().c_str(), .plan = {}, .in_force_since = {}};
  for (const auto& [block, each] : plan.parts) append(each, whole.plan);
  whole.in_force_since = {part.in_force_since()};
  plan.parts.clear();
  return whole;
}

}  // namespace fieldcast
