#include "tools/progress/progress_line.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <mutex>
#include <ostream>
#include <string_view>
#include <utility>

#include "tools/cli/text/cell_text.hpp"

namespace fieldcast {

namespace {

constexpr double kFirstGuess = 0.1;         // seconds
constexpr double kLongest = 100 * 86400.0;  // longer estimates are not shown
constexpr std::size_t kLeastOfWhat = 4;     // columns

}  // namespace

ProgressText progress_text(std::string_view what, double share, Duration elapsed) {
  share = std::clamp(share, 0.0, 1.0);
  ProgressText text{std::string(what), fmt::format("{:.0f} %", share * 100)};
  const double seconds = to_seconds(elapsed);
  if (share <= 0 || seconds < kFirstGuess) return text;
  const double left = seconds / share * (1 - share);
  if (left > kLongest) return text;
  const std::chrono::seconds rounded{static_cast<std::int64_t>(left + 0.5)};
  text.how_far += fmt::format(", {} left", to_text(Duration{rounded}));
  return text;
}

std::string progress_line_text(const ProgressText& text, std::size_t columns) {
  constexpr std::string_view kBetween = ": ";
  const std::string what = cli::shown(text.what), how_far = cli::shown(text.how_far);
  const std::size_t taken = cli::columns_of(how_far) + kBetween.size();
  if (taken + cli::columns_of(what) <= columns) return what + std::string(kBetween) + how_far;
  if (taken + kLeastOfWhat > columns) return cli::cut(how_far, columns);
  return cli::fitted(what, columns - taken) + std::string(kBetween) + how_far;
}

namespace {

constexpr std::chrono::milliseconds kShowAgain{250};
constexpr std::chrono::milliseconds kFirstShown{500};
// maximum time to write a line if the terminal is read
constexpr std::chrono::milliseconds kWriting{50};
constexpr std::string_view kWipe = "\r\x1b[K";
// Free columns after the text for the "^C" of the terminal, which would wrap the line.
constexpr std::size_t kMargin = 3;         // columns
constexpr std::size_t kUnknownWidth = 80;  // columns

// State of the terminal; kept locked at the end of the process.
std::timed_mutex terminal;
bool line_is_shown = false;

std::size_t line_columns() {
  const std::size_t columns = terminal_columns(STDERR_FILENO);
  return (columns > kMargin ? columns : kUnknownWidth) - kMargin;
}

}  // namespace

ProgressLine::ProgressLine(std::ostream& err)
    : err_(err),
      seen_(is_terminal(STDERR_FILENO)),
      began_(std::chrono::steady_clock::now()),
      next_(began_ + kFirstShown) {}

void ProgressLine::show(const Text& text) {
  if (!seen_) return;
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) return;
  next_ = now + kShowAgain;
  const std::string line = progress_line_text(text(now - began_), line_columns());
  const std::lock_guard lock(terminal);
  err_ << kWipe << line << std::flush;
  line_is_shown = true;
}

void ProgressLine::clear() {
  if (!seen_) return;
  const std::lock_guard lock(terminal);
  if (std::exchange(line_is_shown, false)) err_ << kWipe << std::flush;
}

void wipe_progress_at_end() noexcept {
  if (!terminal.try_lock_for(kWriting) || !line_is_shown) return;
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, kWipe.data(), kWipe.size());
}

StepProgress::StepProgress(std::string what, std::size_t steps)
    : what_(std::move(what)), steps_(steps), line_(std::cerr) {}

void StepProgress::step() {
  ++done_;
  line_.show([this](Duration elapsed) {
    return progress_text(what_, static_cast<double>(done_) / static_cast<double>(steps_), elapsed);
  });
}

}  // namespace fieldcast
