// A progress line on standard error, only on a terminal, cleared by the destructor. Main thread,
// one instance at a time; nothing fails.
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

  // Shows the text at most four times a second, and not in the first half second.
  void show(const Text& text);
  void clear();
  [[nodiscard]] bool seen() const { return seen_; }  // standard error is a terminal

 private:
  std::ostream& err_;
  const bool seen_;
  const std::chrono::steady_clock::time_point began_;
  std::chrono::steady_clock::time_point next_;
};

// Clears the line when a signal ends the process from another thread.
void wipe_progress_at_end() noexcept;

}  // namespace fieldcast
