// The terminal as a screen of cells, with ncurses. Restored also after a signal or a crash. Main
// thread; one instance at a time. Call use_terminal_locale() before other threads start.
#pragma once

#include <memory>
#include <optional>

#include "core/base/time.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

// Uses the user's character set, or UTF-8 if that is not Unicode. Returns whether non-ASCII may be
// drawn.
bool use_terminal_locale();

// Empty if a screen is possible. It needs a terminal for input and output with cursor movement.
[[nodiscard]] std::string no_screen_reason();

class Terminal {
 public:
  // Standard error is buffered, up to 64 KiB, and printed at the end. Throws std::runtime_error if
  // the terminal is unusable. REQUIRES: no_screen_reason() is empty.
  Terminal();
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  // Empty at `until`. Ctrl-Z restores the terminal, stops the process, and returns kRedraw
  // afterwards.
  [[nodiscard]] std::optional<Key> key(Instant until);
  void draw(const Frame& frame);
  [[nodiscard]] Screen size() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Restores the terminal when the process must end. Any thread, also in a signal handler.
void give_terminal_back_now() noexcept;

}  // namespace fieldcast::cli
