// How far work of a known number of steps is: one text line on standard error, where that is a
// terminal. Main thread, one at a time; nothing fails.
#pragma once

#include <cstddef>
#include <string>

#include "tools/progress/progress_line.hpp"

namespace fieldcast {

class StepProgress {
 public:
  // The steps should take about the same time: what is left follows from how many are done.
  StepProgress(std::string what, std::size_t steps);

  void step();                     // one more is done
  void clear() { line_.clear(); }  // before something is printed

 private:
  std::string what_;
  std::size_t steps_;
  std::size_t done_ = 0;
  ProgressLine line_;
};

}  // namespace fieldcast
