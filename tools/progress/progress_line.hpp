// One text line that tells how far a program is: on standard error, and only where that is a
// terminal. It is wiped when the object goes. Main thread, one at a time; nothing fails.
#pragma once

#include <chrono>
#include <functional>
#include <iosfwd>

#include "core/base/time.hpp"
#include "tools/progress/progress_text.hpp"

namespace fieldcast {

class ProgressLine {
 public:
  using Text = std::function<ProgressText(Duration elapsed)>;

  // `err` writes to standard error.
  explicit ProgressLine(std::ostream& err);
  ~ProgressLine() { clear(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  // Asks for the text and shows it, four times a second at most, and not in the first half second:
  // what is done by then needs no progress.
  void show(const Text& text);
  void clear();
  [[nodiscard]] bool seen() const { return seen_; }  // by somebody

 private:
  std::ostream& err_;
  const bool seen_;
  const std::chrono::steady_clock::time_point began_;
  std::chrono::steady_clock::time_point next_;
};

// For a process that ends from another thread, at a signal: wipes the line that is shown, if there
// is one; no other one comes.
void wipe_progress_at_end() noexcept;

}  // namespace fieldcast
