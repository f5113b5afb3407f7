// One text line that tells how far a command is: on standard error, and only where that is a
// terminal. It is wiped when the object goes. Main thread.
#pragma once

#include <chrono>
#include <functional>
#include <iosfwd>
#include <string>

#include "core/base/time.hpp"

namespace fieldcast::cli {

class ProgressLine {
 public:
  using Text = std::function<std::string(Duration elapsed)>;

  explicit ProgressLine(std::ostream& err);
  ~ProgressLine() { clear(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  // Asks for the text and shows it, four times a second at most, and not in the first half second:
  // what is done by then needs no progress.
  void show(const Text& text);
  void clear();

 private:
  std::ostream& err_;
  const bool seen_;  // by somebody
  const std::chrono::steady_clock::time_point began_;
  std::chrono::steady_clock::time_point next_;
  bool shown_ = false;
};

}  // namespace fieldcast::cli
