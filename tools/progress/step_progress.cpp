#include "tools/progress/step_progress.hpp"

#include <iostream>
#include <utility>

namespace fieldcast {

StepProgress::StepProgress(std::string what, std::size_t steps)
    : what_(std::move(what)), steps_(steps), line_(std::cerr) {}

void StepProgress::step() {
  ++done_;
  line_.show([this](Duration elapsed) {
    return progress_text(what_, static_cast<double>(done_) / static_cast<double>(steps_), elapsed);
  });
}

}  // namespace fieldcast
