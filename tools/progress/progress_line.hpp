// Formats progress and remaining time. Pure functions.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>

#include "core/base/time.hpp"
#include "tools/progress/terminal.hpp"

namespace fieldcast {

// "simulating line" and "42 %, 65s left"; a narrow terminal truncates the first.
struct ProgressText {
  std::string what;
  std::string how_far;
};

// `share`: finished share, 0 to 1. No estimate in the first tenth of a second.
[[nodiscard]] ProgressText progress_text(std::string_view what, double share, Duration elapsed);

// "what: how far" in at most `columns`. Shortens `what` first, then truncates `how_far`.
[[nodiscard]] std::string progress_line_text(const ProgressText& text, std::size_t columns);

// A progress line on standard error, only on a terminal, cleared by the destructor. Main thread,
// one instance at a time; nothing fails.
class ProgressLine {
 public:
  using Text = std::function<ProgressText(Duration elapsed)>;

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

// Progress line with a known number of steps. Main thread, one instance at a time.
class StepProgress {
 public:
  // The steps should have similar durations, because the estimate uses their count.
  StepProgress(std::string what, std::size_t steps);

  void step();
  void clear() { line_.clear(); }  // call before printing

 private:
  std::string what_;
  std::size_t steps_;
  std::size_t done_ = 0;
  ProgressLine line_;
};

}  // namespace fieldcast
