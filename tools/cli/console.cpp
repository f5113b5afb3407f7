#include "tools/cli/console.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>
#include <ostream>

namespace fieldcast::cli {

bool output_is_terminal() { return isatty(STDOUT_FILENO) == 1; }

bool errors_are_seen() { return isatty(STDERR_FILENO) == 1; }

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

// xterm control sequences: 1049 the other screen, 25 the cursor; H home, K clears to the end of the
// line, J to that of the screen.
LiveScreen::LiveScreen(std::ostream& out) : out_(out) {
  out_ << "\x1b[?1049h\x1b[?25l" << std::flush;
}

LiveScreen::~LiveScreen() { out_ << "\x1b[?25h\x1b[?1049l" << std::flush; }

void LiveScreen::draw(const std::vector<std::string>& lines) {
  std::string text = "\x1b[H";
  for (std::size_t i = 0; i < lines.size(); ++i)
    text += fmt::format("{}{}\x1b[K", i == 0 ? "" : "\r\n", lines[i]);
  out_ << text << "\x1b[J" << std::flush;
}

}  // namespace fieldcast::cli
