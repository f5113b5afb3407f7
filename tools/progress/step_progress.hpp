// Progress line with a known number of steps. Main thread, one instance at a time.
#pragma once

#include <cstddef>
#include <string>

#include "tools/progress/progress_line.hpp"

namespace fieldcast {

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
