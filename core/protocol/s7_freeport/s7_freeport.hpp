// S7-200 freeport: a user-defined protocol of ASCII frames (see s7_freeport.cpp).
#pragma once

#include <array>

#include "core/protocol/protocol_entry.hpp"

namespace fieldcast::s7_freeport {

// Characters of each frame.
inline constexpr std::size_t kRequest = 17, kResponse = 12, kRefusal = 7;

// Codes of refusals. The first three report that the line damaged the request.
inline constexpr std::array kRefusals{
    DeviceCode{1, "wrong check", Cause::kChecksum},
    DeviceCode{2, "wrong length", Cause::kChecksum},
    DeviceCode{3, "not a digit", Cause::kChecksum},
    DeviceCode{4, "unknown command"},
};

[[nodiscard]] const ProtocolEntry& entry();

[[nodiscard]] std::vector<FrameField> explain(ByteView frame);

[[nodiscard]] SeenRequest seen_request(ByteView bytes);

}  // namespace fieldcast::s7_freeport
