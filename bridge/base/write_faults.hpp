// For the start of main(): a failed write returns an error and never ends the process.
#pragma once

#include <csignal>

namespace fieldcast {

// A pipe without a reader then fails with EPIPE, a file at its limit (RLIMIT_FSIZE) with EFBIG.
inline void make_writes_fail_not_kill() {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace fieldcast
