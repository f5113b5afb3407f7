#include "tools/cli/terminal/console.hpp"

#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>

namespace fieldcast::cli {

bool output_is_terminal() { return isatty(STDOUT_FILENO) == 1; }

bool output_is_pipe() {
  struct stat about {};
  return fstat(STDOUT_FILENO, &about) == 0 && S_ISFIFO(about.st_mode);
}

Screen output_screen() {
  if (!output_is_terminal()) return {};
  winsize size{};
  const bool known =
      ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 && size.ws_row > 0;
  // NOLINTNEXTLINE(concurrency-mt-unsafe): nothing sets the environment
  const char* no_colour = std::getenv("NO_COLOR");
  const bool colour = no_colour == nullptr || *no_colour == '\0';
  return known ? Screen{size.ws_col, size.ws_row, colour} : Screen{80, 24, colour};
}

}  // namespace fieldcast::cli
