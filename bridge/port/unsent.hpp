// Writes to a non-blocking descriptor at once, with one system call as a rule, and keeps what it
// does not take.
#pragma once

#include <sys/types.h>

#include "bridge/port/port.hpp"

namespace fieldcast {

class Unsent {
 public:
  enum class Kind { kTerminal, kSocket };
  enum class Outcome { kAllSent, kBlocked, kFailed, kFull };

  explicit Unsent(Kind kind) : kind_(kind) {}

  // Appends bytes to what is unsent and writes as much as the descriptor takes. kBlocked: call
  // again, with no bytes, when it is writable. kFailed: errno says why. kFull: more than
  // Port::kMaxUnsent would wait.
  Outcome write(int fd, ByteView bytes);

 private:
  [[nodiscard]] ssize_t write_some(int fd, ByteView bytes) const;

  Kind kind_;
  Bytes rest_;
};

}  // namespace fieldcast
