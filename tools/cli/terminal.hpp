// The terminal as a screen of cells, with ncurses. Sends only changed cells. Restores the terminal
// also after a signal or a crash.
//
// Main thread; one instance at a time. Call use_terminal_locale() before other threads start.
#pragma once

#include <memory>
#include <optional>

#include "core/base/time.hpp"
#include "tools/cli/screen/frame.hpp"

namespace fieldcast::cli {

// Uses the user's character set, or UTF-8 if that is not Unicode. Returns true if the user's own is
// Unicode: then non-ASCII characters may be drawn.
bool use_terminal_locale();

// Why a screen is not possible: input or output is not a terminal, or it cannot move its cursor.
// Empty: possible.
[[nodiscard]] std::string no_screen_reason();

class Terminal {
 public:
  // Switches to the terminal's alternate screen, which keeps the scroll-back. Standard error is
  // buffered meanwhile, up to 64 KiB, and printed at the end. Throws std::runtime_error if the
  // terminal is unusable. REQUIRES: no_screen_reason() is empty.
  Terminal();
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  // Returns the next key, or empty at `until`. Ctrl-Z restores the terminal, stops the process, and
  // returns kRedraw afterwards.
  [[nodiscard]] std::optional<Key> key(Instant until);
  void draw(const Frame& frame);
  [[nodiscard]] Screen size() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Restores the terminal when the process must end immediately. Any thread, also in a signal
// handler. No effect without a Terminal.
void give_terminal_back_now() noexcept;

}  // namespace fieldcast::cli
