// The terminal, if there is one: its size, its colours, and a region that is redrawn in place. Main
// thread.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "tools/cli/view/text_table.hpp"

namespace fieldcast::cli {

// Standard output as it is now: zero bounds and no colour when it is no terminal; NO_COLOR is
// honoured (no-color.org).
[[nodiscard]] bool output_is_terminal();
[[nodiscard]] bool errors_are_seen();  // standard error is a terminal
[[nodiscard]] Screen output_screen();

// Takes the terminal's other screen while it lives, so that the user's scroll-back stays as it was.
class LiveScreen {
 public:
  explicit LiveScreen(std::ostream& out);
  ~LiveScreen();
  LiveScreen(const LiveScreen&) = delete;
  LiveScreen& operator=(const LiveScreen&) = delete;

  // Replaces what is shown. REQUIRES: the lines fit the screen.
  void draw(const std::vector<std::string>& lines);

 private:
  std::ostream& out_;
};

}  // namespace fieldcast::cli
