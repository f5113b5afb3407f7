#pragma once

#include "core/protocol/protocol_entry.hpp"

namespace fieldcast::df1 {

[[nodiscard]] const ProtocolEntry& entry();

[[nodiscard]] std::vector<FrameField> explain(ByteView frame);

[[nodiscard]] SeenRequest seen_request(ByteView bytes);

}  // namespace fieldcast::df1
