#pragma once

#include "core/protocol/protocol_entry.hpp"

namespace fieldcast::omron {

[[nodiscard]] const ProtocolEntry& hostlink_entry();

[[nodiscard]] std::vector<FrameField> explain_hostlink(ByteView frame);

[[nodiscard]] SeenRequest seen_hostlink_request(ByteView bytes);

}  // namespace fieldcast::omron
