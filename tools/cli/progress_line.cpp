#include "tools/cli/progress_line.hpp"

#include <ostream>
#include <utility>

#include "tools/cli/console.hpp"
#include "tools/cli/screen/cell_text.hpp"

namespace fieldcast::cli {
namespace {

constexpr std::chrono::milliseconds kShowAgain{250};
constexpr std::chrono::milliseconds kFirstShown{500};

}  // namespace

ProgressLine::ProgressLine(std::ostream& err)
    : err_(err),
      seen_(errors_are_seen()),
      began_(std::chrono::steady_clock::now()),
      next_(began_ + kFirstShown) {}

void ProgressLine::show(const Text& text) {
  if (!seen_) return;
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) return;
  next_ = now + kShowAgain;
  err_ << "\r\x1b[K" << cut(shown(text(now - began_)), error_columns() - 1) << std::flush;
  shown_ = true;
}

void ProgressLine::clear() {
  if (std::exchange(shown_, false)) err_ << "\r\x1b[K" << std::flush;
}

}  // namespace fieldcast::cli
