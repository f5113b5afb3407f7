#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/model/channel_pattern.hpp"
#include "tools/cli/screen/row_list.hpp"
#include "tools/cli/text/output.hpp"
#include "tools/cli/view/status/status_facts.hpp"

namespace fieldcast::cli {

// "closed", "offline"; empty if unknown or healthy. REQUIRES: a path without a channel.
[[nodiscard]] Span group_state(const StatusModel& model, const ChannelPath& id);

[[nodiscard]] std::vector<FrameLine> status_details(const StatusModel& model, const ChannelPath& id,
                                                    UtcTime now, std::size_t columns);

[[nodiscard]] Rank rank_of(const StationBusStatus& bus);
[[nodiscard]] Rank rank_of(const StationDeviceStatus& device);
[[nodiscard]] Rank rank_of(const StandbyMessage& member);

// A standby group is listed like a bus. "group line-7" has a space, so no bus has this name.
[[nodiscard]] ChannelPath group_row_id(const std::string& group, const std::string& bridge = {});
[[nodiscard]] std::string standby_group_of(const ChannelPath& id);
// Null if the row is not a member or the member was removed.
[[nodiscard]] const StandbyMessage* member_of(const StatusModel& model, const ChannelPath& id);

struct StatusChoice {
  bool by_name = false;   // false: bad first
  bool bad_only = false;  // hides healthy rows
  std::string filter;     // words: each must occur in name, state or causes
};

// Rows of `fieldcast status`: buses with devices, standby groups with members. Pure.
// Omits members of groups folded in `list`.
[[nodiscard]] ListRows status_rows(const StatusModel& model, const StatusChoice& choice,
                                   const RowList& list);

}  // namespace fieldcast::cli
