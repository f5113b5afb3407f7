// The request of a master, recognised in bytes that this bridge did not ask for: somebody else
// speaks on the wire. Each protocol says how its requests look; `core/bus/wire_fence.hpp` uses it.
//
// Plain values and pure functions, any thread.
#pragma once

#include <cstddef>

#include "core/base/bytes.hpp"

namespace fieldcast {

struct SeenRequest {
  std::size_t size = 0;  // characters; 0: none
  // False: a device's answer can look the same.
  bool certain = true;
  [[nodiscard]] explicit operator bool() const { return size > 0; }
};

// The whole request, with a right check, that stands at the beginning of the bytes, to whatever
// device it goes. What lacks characters is none.
using RequestMatcher = SeenRequest (*)(ByteView bytes);

}  // namespace fieldcast
