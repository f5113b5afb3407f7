#pragma once

#include "core/protocol/protocol_entry.hpp"

namespace fieldcast::df1 {

[[nodiscard]] const ProtocolEntry& entry();

[[nodiscard]] std::vector<FrameField> explain(ByteView frame);

}  // namespace fieldcast::df1
