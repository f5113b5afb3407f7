// Frames without their escapes, and without the bytes that wake up a receiver. Pure.
#pragma once

#include <string_view>

#include "tools/cli/inspect/learn/exchange_pairing.hpp"

namespace fieldcast::learn {

struct PlainFrames {
  std::string_view escape;  // as a declaration names it; empty: none
  bool lead = false;        // responses began with wake-up bytes
  std::vector<Exchange> exchanges;
};
// The form in which most frames have a checksum; of several the first: as they are.
[[nodiscard]] PlainFrames plain_frames(const std::vector<Exchange>& exchanges);

}  // namespace fieldcast::learn
