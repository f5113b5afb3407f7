#include "bridge/log/log.hpp"

#include <fmt/format.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <mutex>

#include "bridge/base/clock.hpp"
#include "bridge/log/log_lines.hpp"
#include "core/base/message_text.hpp"

namespace fieldcast {
namespace {

constexpr std::size_t kMaxSubject = 256;  // bytes

struct Level {
  spdlog::level::level_enum level;
  std::string_view colour;
  std::string_view priority;  // sd-daemon(3)
};
// In the order of LogLevel.
constexpr std::array<Level, 4> kLevels{{{spdlog::level::err, "\x1b[31;1m", "<3>"},
                                        {spdlog::level::warn, "\x1b[33;1m", "<4>"},
                                        {spdlog::level::info, "\x1b[32m", "<6>"},
                                        {spdlog::level::debug, "\x1b[36m", "<7>"}}};

spdlog::level::level_enum level_of(LogLevel level) {
  return kLevels[static_cast<std::size_t>(level)].level;
}

enum class Decoration { kNone, kColour, kPriority };

// Formats on the thread that logs; the LineWriter writes.
class QueueSink final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  QueueSink(LineWriter& lines, Decoration decoration) : lines_(lines), decoration_(decoration) {}

 private:
  void sink_it_(const spdlog::details::log_msg& message) override {
    spdlog::memory_buf_t buffer;
    formatter_->format(message, buffer);
    std::string line(buffer.data(), buffer.size());
    const Level& level = *std::ranges::find(kLevels, message.level, &Level::level);
    if (decoration_ == Decoration::kPriority) line.insert(0, level.priority);
    if (decoration_ == Decoration::kColour && message.color_range_end > message.color_range_start) {
      line.insert(message.color_range_end, "\x1b[0m");
      line.insert(message.color_range_start, level.colour);
    }
    lines_.put(std::move(line));
  }
  void flush_() override {}

  LineWriter& lines_;
  const Decoration decoration_;
};

std::shared_ptr<spdlog::logger> make_logger(const char* name, LineWriter& lines,
                                            Decoration decoration, const char* pattern) {
  auto made =
      std::make_shared<spdlog::logger>(name, std::make_shared<QueueSink>(lines, decoration));
  made->set_pattern(pattern);
  return made;
}

// Never destroyed: threads may log until the process ends.
LineWriter& error_lines() {
  static auto& lines = *new LineWriter(STDERR_FILENO, [](std::uint64_t lost) {
    return fmt::format("{} lines of the log are missing here: they could not be written in time\n",
                       lost);
  });
  return lines;
}

LineWriter& trace_lines() {
  static auto& lines = *new LineWriter(STDOUT_FILENO, [](std::uint64_t lost) {
    return fmt::format(
        "{} lines of the trace are missing here: they could not be written in time\n", lost);
  });
  return lines;
}

// NOLINTNEXTLINE(concurrency-mt-unsafe): nothing sets the environment
bool colourful(int fd) { return ::isatty(fd) == 1 && std::getenv("NO_COLOR") == nullptr; }

// systemd.exec(5): $JOURNAL_STREAM is "device:inode" of the stream that the journal reads.
bool read_by_journal(int fd) {
  const char* stream = std::getenv("JOURNAL_STREAM");  // NOLINT(concurrency-mt-unsafe)
  struct stat file {};
  return stream && ::fstat(fd, &file) == 0 &&
         fmt::format("{}:{}", file.st_dev, file.st_ino) == stream;
}

std::shared_ptr<spdlog::logger> make_error_logger() {
  if (read_by_journal(STDERR_FILENO))
    return make_logger("fieldcast", error_lines(), Decoration::kPriority, "%v");
  return make_logger("fieldcast", error_lines(),
                     colourful(STDERR_FILENO) ? Decoration::kColour : Decoration::kNone,
                     "%Y-%m-%dT%H:%M:%S.%e %^%l%$ %v");
}

spdlog::logger& logger() {
  static auto& instance = *new std::shared_ptr<spdlog::logger>(make_error_logger());
  return *instance;
}

spdlog::logger& tracer() {
  static auto& instance = *new std::shared_ptr<spdlog::logger>(
      make_logger("trace", trace_lines(), Decoration::kNone, "%v"));
  return *instance;
}

std::mutex counted_mutex;
LineBudget& counted() {
  static auto& budget = *new LineBudget;
  return budget;
}

std::string_view mark_text(TraceMark mark) {
  switch (mark) {
    case TraceMark::kSent: return ">>";
    case TraceMark::kReceived: return "<<";
    case TraceMark::kRemark: return "--";
  }
  return "--";
}

}  // namespace

void open_log(LogLevel level) { logger().set_level(level_of(level)); }

void reopen_log() {
  error_lines().reopen(STDERR_FILENO);
  const std::lock_guard lock(counted_mutex);
  counted() = {};
}

void log_line(LogLevel level, std::string_view subject, std::string_view text) {
  spdlog::logger& log = logger();
  if (!log.should_log(level_of(level))) return;
  log.log(level_of(level), "{}: {}", printable(subject, kMaxSubject), printable(text));
}

void log_counted(LogLevel level, std::string_view subject, std::string_view kind,
                 std::string_view text) {
  if (!logger().should_log(level_of(level))) return;
  LineVerdict verdict;
  {
    const std::lock_guard lock(counted_mutex);
    verdict = counted().occurred(kind, steady_now());
  }
  if (!verdict.log) return;
  if (verdict.suppressed == 0) return log_line(level, subject, text);
  log_line(level, subject, fmt::format("{} ({} more {} before)", text, verdict.suppressed, kind));
}

void log_summaries(Instant now) {
  std::vector<LineSummary> summaries;
  {
    const std::lock_guard lock(counted_mutex);
    summaries = counted().summaries(now);
  }
  for (const auto& summary : summaries)
    log_warning("log", fmt::format("{}: {} more in {}", summary.key, summary.suppressed,
                                   to_text(LineBudget::kPeriod)));
}

void flush_log(Duration limit) {
  const Instant end = steady_now() + limit;
  (void)error_lines().flush(limit);
  (void)trace_lines().flush(std::max(end - steady_now(), Duration::zero()));
}

void trace_line(UtcTime at, std::string_view bus, TraceMark mark, std::string_view text) {
  const std::time_t seconds = static_cast<std::time_t>(at.nanoseconds / 1'000'000'000);
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  tracer().info("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:06}Z {} {} {}", parts.tm_year + 1900,
                parts.tm_mon + 1, parts.tm_mday, parts.tm_hour, parts.tm_min, parts.tm_sec,
                at.nanoseconds / 1000 % 1'000'000, bus, mark_text(mark), text);
}

}  // namespace fieldcast
