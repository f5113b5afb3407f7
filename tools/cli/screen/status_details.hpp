#pragma once

#include <cstddef>
#include <vector>

#include "core/model/channel_pattern.hpp"
#include "tools/cli/text/frame.hpp"
#include "tools/cli/view/status/status_facts.hpp"

namespace fieldcast::cli {

// "closed", "offline"; empty if unknown or healthy. REQUIRES: a path without a channel.
[[nodiscard]] Span group_state(const StatusModel& model, const ChannelPath& id);

[[nodiscard]] std::vector<FrameLine> status_details(const StatusModel& model, const ChannelPath& id,
                                                    UtcTime now, std::size_t columns);

}  // namespace fieldcast::cli
