#include "tools/cli/terminal/terminal_name.hpp"

#include <unistd.h>

#include <cstdlib>

// Include these two last: their macros are common words.
#include <curses.h>
#include <term.h>

namespace fieldcast::cli {

std::string terminal_name() {
  // NOLINTNEXTLINE(concurrency-mt-unsafe): nothing sets the environment
  const char* name = std::getenv("TERM");
  return name == nullptr ? "" : name;
}

std::string usable_terminal_name() {
  const std::string name = terminal_name();
  int fault = 0;
  if (name.empty() || ::setupterm(name.c_str(), STDOUT_FILENO, &fault) != 0)
    return name.empty() || name == "dumb" ? "" : "xterm";
  const std::string capability = "cup";
  const char* move_cursor = ::tigetstr(capability.c_str());
  ::del_curterm(::set_curterm(nullptr));
  return move_cursor != nullptr && move_cursor != reinterpret_cast<const char*>(-1) ? name : "";
}

}  // namespace fieldcast::cli
