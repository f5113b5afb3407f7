// To add a key, add a row in channel_keys.cpp.
#pragma once

#include "config/channel/cascade.hpp"
#include "config/document/key.hpp"

namespace fieldcast::config {

[[nodiscard]] const Rows<ChannelDefaults>& channel_rows();
[[nodiscard]] const Rows<Limits>& limit_rows();
[[nodiscard]] const Rows<ChannelSpec>& write_rows();

// Values of `byte`: low and high are those of a word.
inline constexpr std::pair<std::string_view, std::uint8_t> kByteWords[] = {
    {"low", 0}, {"high", 1}, {"0", 0}, {"1", 1}, {"2", 2},
    {"3", 3},   {"4", 4},    {"5", 5}, {"6", 6}, {"7", 7}};

}  // namespace fieldcast::config
