#include "bridge/base/check.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace fieldcast {

void end_for_broken_rule(const char* file, int line, const char* condition) {
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
