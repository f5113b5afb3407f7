#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bridge/standby/standby_values.hpp"
#include "core/base/json.hpp"
#include "tools/cli/text/text_table.hpp"

namespace fieldcast::cli {

// By group and bridge.
using StandbyModel = std::map<std::pair<std::string, std::string>, StandbyMessage>;

[[nodiscard]] Tone tone_of(const StandbyMessage& member);
// The master of the greatest term, also during a handover; null: the group has none.
[[nodiscard]] const StandbyMessage* master_of(const StandbyModel& model, const std::string& group);

[[nodiscard]] std::vector<std::string> standby_lines(const StandbyModel& model,
                                                     const Screen& screen);

// The fields of Standby by their IDL names, and "topic".
[[nodiscard]] Json standby_json(const StandbyMessage& message);

// Blocks of the master that a waiting member has not received yet.
[[nodiscard]] std::uint64_t behind(const StandbyModel& model, const StandbyMessage& member);

}  // namespace fieldcast::cli
