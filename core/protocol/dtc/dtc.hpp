// DTC as a protocol (protocol.hpp): any number of scattered variables of several types in one
// message, compressed where that pays.
#pragma once

#include "core/protocol/registry.hpp"

namespace fieldcast::dtc {

[[nodiscard]] const ProtocolEntry& entry();

// A packet, the message in it and, of a request, its groups.
[[nodiscard]] std::vector<FrameField> explain(ByteView frame);

// Nothing in a message says whether it is a request: its answer may look like groups by chance.
[[nodiscard]] SeenRequest seen_request(ByteView bytes);

}  // namespace fieldcast::dtc
