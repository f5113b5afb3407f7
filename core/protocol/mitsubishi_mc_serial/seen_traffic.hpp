// Requests of any master in received characters.
#pragma once

#include <optional>

#include "core/base/bytes.hpp"
#include "core/protocol/mitsubishi_mc_serial/frame.hpp"

namespace fieldcast::mitsubishi_mc {

// The frame whose header begins the text, in ASCII or binary code. A 1C frame has no identifier.
[[nodiscard]] SerialFrame frame_of(ByteView text, bool binary);

// Characters of a request in ASCII code from its command on. Empty for an unknown command, or if
// characters are missing.
[[nodiscard]] std::optional<std::size_t> content_size(ByteView content, SerialFrame frame);

}  // namespace fieldcast::mitsubishi_mc
