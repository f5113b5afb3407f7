#include "bridge/log.hpp"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <ctime>

namespace fieldcast {
namespace {

spdlog::level::level_enum level_of(LogLevel level) {
  switch (level) {
    case LogLevel::kDebug: return spdlog::level::debug;
    case LogLevel::kInfo: return spdlog::level::info;
    case LogLevel::kWarning: return spdlog::level::warn;
    case LogLevel::kError: return spdlog::level::err;
  }
  return spdlog::level::err;
}

spdlog::logger& logger() {
  static const auto instance = [] {
    auto made = spdlog::stderr_color_mt("fieldcast");
    made->set_pattern("%Y-%m-%dT%H:%M:%S.%e %^%l%$ %v");
    made->flush_on(spdlog::level::debug);
    return made;
  }();
  return *instance;
}

spdlog::logger& tracer() {
  static const auto instance = [] {
    auto made = spdlog::stdout_logger_mt("trace");
    made->set_pattern("%v");
    made->flush_on(spdlog::level::info);
    return made;
  }();
  return *instance;
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

void log_line(LogLevel level, std::string_view place, std::string_view text) {
  spdlog::logger& log = logger();
  if (!log.should_log(level_of(level))) return;
  log.log(level_of(level), "{}: {}", place, text);
}

void trace_line(UtcTime at, std::string_view bus, TraceMark mark, std::string_view text) {
  const std::time_t seconds = static_cast<std::time_t>(at.nanoseconds / 1'000'000'000);
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  tracer().info("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:06}Z {} {} {}", parts.tm_year + 1900, parts.tm_mon + 1, parts.tm_mday,
                parts.tm_hour, parts.tm_min, parts.tm_sec, at.nanoseconds / 1000 % 1'000'000, bus, mark_text(mark), text);
}

}  // namespace fieldcast
