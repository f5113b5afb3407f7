#include "tools/progress/progress_line.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <mutex>
#include <ostream>
#include <string_view>
#include <utility>

namespace fieldcast {
namespace {

constexpr std::chrono::milliseconds kShowAgain{250};
constexpr std::chrono::milliseconds kFirstShown{500};
// maximum time to write a line if the terminal is read
constexpr std::chrono::milliseconds kWriting{50};
constexpr std::string_view kWipe = "\r\x1b[K";
// Free columns after the text for the "^C" of the terminal, which would wrap the line.
constexpr std::size_t kMargin = 3;  // columns

// State of the terminal; kept locked at the end of the process.
std::timed_mutex terminal;
bool line_is_shown = false;

std::size_t terminal_columns() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > kMargin ? size.ws_col : 80;
}

}  // namespace

ProgressLine::ProgressLine(std::ostream& err)
    : err_(err),
      seen_(::isatty(STDERR_FILENO) == 1),
      began_(std::chrono::steady_clock::now()),
      next_(began_ + kFirstShown) {}

void ProgressLine::show(const Text& text) {
  if (!seen_) return;
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) return;
  next_ = now + kShowAgain;
  const std::string line = progress_line_text(text(now - began_), terminal_columns() - kMargin);
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

}  // namespace fieldcast
