// How the scheduler forms blocks of channels.
#pragma once

#include <cstdint>
#include <string_view>

namespace fieldcast {

// A configuration selects one of the first two; the others only serve comparison.
enum class Planner : std::uint8_t {
  kCyclic,  // the most urgent point, with points that are cheaper to read together
  // The most urgent points with their near neighbours, at most 20 blocks at a time.
  kDynamicBlocks,
  // Fixed groups (the optimal partition), each read at the rate of its fastest member.
  kFastestMember,
  kOnePerChannel,  // every point in a separate read
};
[[nodiscard]] std::string_view to_text(Planner planner);  // "cyclic", "dynamic", ...

}  // namespace fieldcast
