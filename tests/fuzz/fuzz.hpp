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

}  // namespace fieldcast::fuzz
