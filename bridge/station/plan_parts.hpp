// Puts the parts of plans together, which may come in any order and of which one may belong to
// another plan than the next. Pure: no DDS entity, no clock, no thread; one owner.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "bridge/dds/topics/conversion.hpp"

namespace fieldcast {

class PlanParts {
 public:
  // The whole plan when this part was the last that it lacked.
  [[nodiscard]] std::optional<StationReadPlan> on_part(const idl::ReadPlan& part);
  void forget(const std::string& bus) { buses_.erase(bus); }

 private:
  struct Plan {
    std::uint64_t number = 0;
    std::map<std::uint32_t, idl::ReadPlan> parts;  // until they are whole; at most kMaxPlanBlocks
  };
  std::map<std::string, Plan> buses_;  // as many as the reader has instances
};

}  // namespace fieldcast
