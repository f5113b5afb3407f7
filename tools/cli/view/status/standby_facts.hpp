// Named facts of standby groups for the screen of `fieldcast status`. Pure functions.
#pragma once

#include <string>
#include <vector>

#include "tools/cli/view/status/status_facts.hpp"

namespace fieldcast::cli {

// "master", "waiting", "not ready": short text for a column.
[[nodiscard]] std::string role_text(const StandbyMessage& member);

// The state is first: the master, or why a member does not take over.
[[nodiscard]] std::vector<StatusFact> group_facts(const StandbyModel& model,
                                                  const std::string& group);
[[nodiscard]] std::vector<StatusFact> member_facts(const StandbyModel& model,
                                                   const StandbyMessage& member);

}  // namespace fieldcast::cli
