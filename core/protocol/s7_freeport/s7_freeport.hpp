// S7-200 freeport: a user-defined protocol of ASCII frames on an S7-200's free port (s7_freeport.cpp).
#pragma once

#include "core/protocol/protocol.hpp"

namespace fieldcast::s7_freeport {

[[nodiscard]] const ProtocolEntry& entry();

[[nodiscard]] std::vector<FrameField> explain(ByteView frame);

}  // namespace fieldcast::s7_freeport
