// The terminal as a screen of cells, by ncurses: frames go out, keys come in. Only what changed is
// sent. It is given back as it was, also when the process is ended by a signal or crashes.
//
// Main thread; one at a time. use_terminal_locale() before there are other threads.
#pragma once

#include <memory>
#include <optional>

#include "core/base/time.hpp"
#include "tools/cli/screen/frame.hpp"

namespace fieldcast::cli {

// Takes the user's character set, and UTF-8 where that is none of Unicode. True when the user's own
// is Unicode: more than ASCII may be drawn.
bool use_terminal_locale();

// Why there can be no screen: input or output is no terminal, or it cannot move its cursor. Empty:
// there can.
[[nodiscard]] std::string no_screen_reason();

class Terminal {
 public:
  // Takes the terminal's other screen; the scroll-back stays as it was. What is written to standard
  // error meanwhile is kept, 64 KiB at most, and written when the screen is given back. Throws
  // std::runtime_error when the terminal cannot be used. REQUIRES: no_screen_reason() is empty.
  Terminal();
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  // The next key; waits until the limit at most. Ctrl-Z gives the terminal back, stops the process
  // and comes back as kRedraw.
  [[nodiscard]] std::optional<Key> key(Instant until);
  void draw(const Frame& frame);
  [[nodiscard]] Screen size() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Gives the terminal back from wherever the process is when it must end at once: any thread, also a
// signal handler. Nothing happens without a Terminal.
void give_terminal_back_now() noexcept;

}  // namespace fieldcast::cli
