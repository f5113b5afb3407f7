// DTC: scattered variables of several types in one message, compressed if that saves time.
#pragma once

#include "core/protocol/protocol_entry.hpp"

namespace fieldcast::dtc {

[[nodiscard]] const ProtocolEntry& entry();

[[nodiscard]] std::vector<FrameField> explain(ByteView frame);

// The result is not certain for reads: a response may look like groups by chance.
[[nodiscard]] SeenRequest seen_request(ByteView bytes);

}  // namespace fieldcast::dtc
