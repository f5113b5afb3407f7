// A request of another master in unsolicited bytes; used by core/bus/wire/wire_fence.hpp. Any
// thread.
#pragma once

#include <cstddef>

#include "core/base/bytes.hpp"

namespace fieldcast {

struct SeenRequest {
  std::size_t size = 0;  // characters; 0 if none
  // False if a device's response can look the same.
  bool certain = true;
  [[nodiscard]] explicit operator bool() const { return size > 0; }
};

// Matches a whole request to any device, with a valid check, at the beginning of the bytes.
using RequestMatcher = SeenRequest (*)(ByteView bytes);

}  // namespace fieldcast
