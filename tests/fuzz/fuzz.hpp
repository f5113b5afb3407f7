#pragma once

#include <cstdlib>
#include <string>
#include <vector>

#include "core/protocol/protocol.hpp"

// Defines the entry of a target, which calls run(ByteView).
#define FIELDCAST_FUZZ_TARGET(run)                                                    \
  extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) { \
    run({data, size});                                                                \
    return 0;                                                                         \
  }

namespace fieldcast::fuzz {

inline void require(bool holds) {
  if (!holds) std::abort();
}

inline bool is_one_line(const std::string& text) {
  return !text.empty() && text.find('\n') == std::string::npos;
}

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
