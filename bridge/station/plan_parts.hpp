// Assembles plans from their parts, which may arrive in any order and belong to different plans.
// Pure: no DDS entity, no clock, no thread; one owner.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "bridge/dds/topics/conversion.hpp"

namespace fieldcast {

class PlanParts {
 public:
  // Returns the whole plan if this part completes it.
  [[nodiscard]] std::optional<StationReadPlan> on_part(const idl::ReadPlan& part);
  void forget(const std::string& bus) { buses_.erase(bus); }

 private:
  struct Plan {
    std::uint64_t number = 0;
    // until the plan is complete; at most kMaxPlanBlocks
    std::map<std::uint32_t, idl::ReadPlan> parts;
  };
  std::map<std::string, Plan> buses_;  // as many as the reader has instances
};

}  // namespace fieldcast
