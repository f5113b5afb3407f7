// For the beginning of main(): a write that cannot be done is an error of that write, never the
// death of the process. Standard C++, so that every program of ours may use it.
#pragma once

#include <csignal>

namespace fieldcast {

// A pipe that nobody reads any more gives EPIPE, a file beyond its limit (RLIMIT_FSIZE) EFBIG.
inline void make_writes_fail_not_kill() {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace fieldcast
