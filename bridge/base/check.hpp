// An assertion in every build: a violated internal rule ends the process with file and line.
#pragma once

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace fieldcast {

// Writes the rule to standard error if writable within 100 ms, and ends the process.
[[noreturn]] inline void end_for_broken_rule(const char* file, int line, const char* condition) {
  char text[512];
  const int size =
      std::snprintf(text, sizeof text, "%s:%d: broken rule: %s\n", file, line, condition);
  pollfd writable{STDERR_FILENO, POLLOUT, 0};
  if (size > 0 && ::poll(&writable, 1, 100) > 0) {
    const auto length = std::min(static_cast<std::size_t>(size), sizeof text - 1);
    [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, text, length);
  }
  std::abort();
}

}  // namespace fieldcast

#define FIELDCAST_CHECK(condition)                                      \
  do {                                                                  \
    if (!(condition)) [[unlikely]]                                      \
      ::fieldcast::end_for_broken_rule(__FILE__, __LINE__, #condition); \
  } while (false)
