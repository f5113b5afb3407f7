// The columns of the channels' list, by the width of the screen. Pure functions.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "tools/cli/screen/channel_rows.hpp"
#include "tools/cli/screen/frame.hpp"

namespace fieldcast::cli {

// Heads at 80 columns: channel, value, unit, quality, age, refresh; wider ones have the rate too,
// narrower ones leave out what matters least. At 20 columns: name, value and one letter.
[[nodiscard]] FrameLine channel_heads(std::size_t columns);

// REQUIRES: a row of a channel. `grouped`: the name alone, moved in below its device.
[[nodiscard]] FrameLine channel_line(const ListRow& row, const StationChannel* about, bool grouped,
                                     const Moment& moment, std::size_t columns);

// What a click on the heads at this column sorts by. Nothing: the column sorts nothing.
[[nodiscard]] std::optional<ChannelOrder> order_at(std::size_t column, std::size_t columns);

}  // namespace fieldcast::cli
