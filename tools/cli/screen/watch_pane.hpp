// Columns of the channel list by the width of the screen. Pure functions.
#pragma once

#include <cstddef>
#include <optional>

#include "tools/cli/screen/channel_rows.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

// Heads at 80 columns: channel, value, unit, quality, age, refresh; wider ones add the rate. At 20
// columns: name, value and one letter.
[[nodiscard]] FrameLine channel_heads(std::size_t columns);

// REQUIRES: a channel row. `grouped`: only the channel name, indented.
[[nodiscard]] FrameLine channel_line(const ListRow& row, const StationChannel* about, bool grouped,
                                     const Moment& moment, std::size_t columns);

[[nodiscard]] std::optional<ChannelOrder> order_at(std::size_t column, std::size_t columns);

}  // namespace fieldcast::cli
