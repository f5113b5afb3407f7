// The end of a frame, and its names. Pure.
#pragma once

#include <utility>
#include <vector>

#include "tools/cli/inspect/learn/proposal.hpp"

namespace fieldcast::learn {

// The end of the frames of one direction: a checksum, constants, or both.
struct FrameEnd {
  std::optional<FoundChecksum> check;
  std::size_t size = 0;
};
// `common`: the checksum of all frames of this direction, if they have one.
[[nodiscard]] FrameEnd end_of(const Frames& frames, const std::optional<FoundChecksum>& common,
                              bool text);

// Of each length field: its position, and the first character that it counts.
using LengthSpans = std::vector<std::pair<std::ptrdiff_t, std::ptrdiff_t>>;

// Appends the end, names the fields, and resolves what lengths and the checksum cover.
[[nodiscard]] std::vector<LearnedField> with_end(std::vector<LearnedField> fields,
                                                 const FrameEnd& end, const Frames& frames,
                                                 const LengthSpans& spans);

}  // namespace fieldcast::learn
