#pragma once

#include "core/protocol/protocol_entry.hpp"

namespace fieldcast::mitsubishi_mc {

[[nodiscard]] const ProtocolEntry& entry();

[[nodiscard]] std::vector<FrameField> explain(ByteView frame);

}  // namespace fieldcast::mitsubishi_mc
