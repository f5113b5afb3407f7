#pragma once

#include "bridge/base/command_line.hpp"
#include "core/model/channel_pattern.hpp"

namespace fieldcast::cli {

inline constexpr const char* kPatternHelp =
    "BUS/DEVICE/CHANNEL with *; a shorter one matches all below it";

// REQUIRES: `target` lives until the parse.
[[nodiscard]] inline CommandLine::Take pattern_into(Pattern& target) {
  return [&target](const std::string& text) -> std::optional<std::string> {
    auto pattern = Pattern::parse(text);
    if (!pattern) return pattern.error();
    target = *std::move(pattern);
    return std::nullopt;
  };
}

}  // namespace fieldcast::cli
