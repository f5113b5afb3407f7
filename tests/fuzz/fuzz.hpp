// What the fuzz targets share.
#pragma once

#include <cstdlib>
#include <vector>

#include "core/protocol/protocol.hpp"

namespace fieldcast::fuzz {

// Every line of an explanation lies inside the frame.
inline void check_explanation(const std::vector<FrameField>& fields, std::size_t size) {
  for (const FrameField& field : fields) {
    if (field.offset > size || field.length > size - field.offset) std::abort();
  }
}

// Whether what this input holds is explained too: one in eight is. A text for people takes longer
// to make than what the bytes mean, and has less to find.
inline bool is_explained(ByteView data) {
  unsigned sum = 0;
  for (const std::uint8_t byte : data) sum += byte;
  return sum % 8 == 0;
}

}  // namespace fieldcast::fuzz
