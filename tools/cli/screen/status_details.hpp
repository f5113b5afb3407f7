// What the screens tell of a bus and of a device. Pure functions.
#pragma once

#include <cstddef>
#include <vector>

#include "core/model/channel_path.hpp"
#include "tools/cli/screen/frame.hpp"
#include "tools/cli/view/status_facts.hpp"

namespace fieldcast::cli {

// "closed", "offline", with its colour; empty when nothing is known of it, or when all is well.
// REQUIRES: a path without a channel.
[[nodiscard]] Span group_state(const StatusModel& model, const ChannelPath& id);

// Its name, then each fact on a line or more.
[[nodiscard]] std::vector<FrameLine> status_details(const StatusModel& model, const ChannelPath& id,
                                                    UtcTime now, std::size_t columns);

}  // namespace fieldcast::cli
