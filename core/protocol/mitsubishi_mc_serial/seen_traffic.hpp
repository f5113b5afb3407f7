// Requests of any master in received characters.
#pragma once

#include <optional>

#include "core/base/bytes.hpp"
#include "core/protocol/mitsubishi_mc_serial/frame.hpp"

namespace fieldcast::mitsubishi_mc {

// The frame whose header begins the text, in ASCII code. A 1C frame has no identifier.
[[nodiscard]] SerialFrame frame_of(ByteView text);

struct AsciiRequest {
  SerialFormat format;   // frame and block number
  std::size_t size = 0;  // characters from the block number or the header on, without 03 and sum
  bool certain = true;   // false if the characters can be those of a response
};
// The request in ASCII code that begins the text, which is behind 05 or 02. Empty for an unknown
// command, or if characters are missing.
[[nodiscard]] std::optional<AsciiRequest> ascii_request(ByteView text);

}  // namespace fieldcast::mitsubishi_mc
