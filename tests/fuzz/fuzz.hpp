#pragma once

#include <cstdlib>
#include <vector>

#include "core/protocol/protocol.hpp"

namespace fieldcast::fuzz {

// Checks that every line of an explanation is inside the frame.
inline void check_explanation(const std::vector<FrameField>& fields, std::size_t size) {
  for (const FrameField& field : fields) {
    if (field.offset > size || field.length > size - field.offset) std::abort();
  }
}

// Explains one input in eight, because an explanation is slow and has less to find.
inline bool is_explained(ByteView data) {
  unsigned sum = 0;
  for (const std::uint8_t byte : data) sum += byte;
  return sum % 8 == 0;
}

}  // namespace fieldcast::fuzz
