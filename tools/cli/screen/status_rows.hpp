// Which rows the screen of `fieldcast status` lists, and in which order: buses with their devices,
// standby groups with their members. Pure.
#pragma once

#include <string>

#include "tools/cli/screen/row_list.hpp"
#include "tools/cli/view/status_facts.hpp"

namespace fieldcast::cli {

[[nodiscard]] Rank rank_of(const StationBusStatus& bus);
[[nodiscard]] Rank rank_of(const StationDeviceStatus& device);
[[nodiscard]] Rank rank_of(const StandbyMessage& member);

// A standby group stands in the list as a bus would, and its members as devices. No bus has such a
// name: "group line-7" has a blank.
[[nodiscard]] ChannelPath group_row_id(const std::string& group, const std::string& bridge = {});
// The group of such a row; empty: it is a row of a bus or of a device.
[[nodiscard]] std::string standby_group_of(const ChannelPath& id);
// Null: the row is no member of a standby group, or the member is gone.
[[nodiscard]] const StandbyMessage* member_of(const StatusModel& model, const ChannelPath& id);

struct StatusChoice {
  bool by_name = false;   // else bad first
  bool bad_only = false;  // without what is as it should be
  std::string filter;     // words: each is somewhere in name, state or causes
};
// Without those in groups that `list` has folded.
[[nodiscard]] ListRows status_rows(const StatusModel& model, const StatusChoice& choice,
                                   const RowList& list);

}  // namespace fieldcast::cli
