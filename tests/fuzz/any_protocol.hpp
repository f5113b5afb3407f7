// Feeds bytes to any protocol as the response to a request, and for one input in eight to the
// explainer.
//
// Input: area, first, count, kind of request, cut; then for each round length(1) and that many
// response bytes.
#pragma once

#include <functional>

#include "core/protocol/protocol.hpp"

namespace fieldcast::fuzz {

void run_protocol(const Protocol& protocol,
                  const std::function<std::vector<FrameField>(ByteView)>& explain, ByteView data);

}  // namespace fieldcast::fuzz
