// What a fuzz target does with any protocol: bytes as the answers to a request, and into the
// explainer; the latter for one input in eight.
//
// Input: area, first, count, kind of request, cut; then for each round length(1) and so many bytes
// of answer.
#pragma once

#include <functional>

#include "core/protocol/protocol.hpp"

namespace fieldcast::fuzz {

void run_protocol(const Protocol& protocol,
                  const std::function<std::vector<FrameField>(ByteView)>& explain, ByteView data);

}  // namespace fieldcast::fuzz
