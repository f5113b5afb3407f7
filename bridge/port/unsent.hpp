// Writes to a non-blocking descriptor, usually with one system call, and buffers the rest.
#pragma once

#include <sys/types.h>

#include "bridge/port/port.hpp"

namespace fieldcast {

class Unsent {
 public:
  enum class Kind { kTerminal, kSocket };
  enum class Outcome { kAllSent, kBlocked, kFailed, kFull };

  explicit Unsent(Kind kind) : kind_(kind) {}

  // Appends bytes and writes as many as the descriptor accepts. kBlocked: call again without bytes
  // when writable. kFailed: see errno. kFull: more than Port::kMaxUnsent bytes would wait.
  Outcome write(int fd, ByteView bytes);

 private:
  [[nodiscard]] ssize_t write_some(int fd, ByteView bytes) const;

  Kind kind_;
  Bytes rest_;
};

}  // namespace fieldcast
