#pragma once

#include "core/protocol/protocol_entry.hpp"

namespace fieldcast::mitsubishi_mc {

[[nodiscard]] const ProtocolEntry& serial_entry();

[[nodiscard]] std::vector<FrameField> explain_serial(ByteView frame);

// Matches requests of all frames and formats with a sum.
[[nodiscard]] SeenRequest seen_serial_request(ByteView bytes);

}  // namespace fieldcast::mitsubishi_mc
