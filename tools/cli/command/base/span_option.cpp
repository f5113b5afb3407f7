#include "tools/cli/command/base/span_option.hpp"

#include "tools/cli/model/time_text.hpp"
#include "tools/cli/terminal/clock.hpp"

namespace fieldcast::cli {

void SpanOption::describe(CommandLine& line) {
  line.text("--from", from_, "2026-11-21T10:30 (UTC), or 2h, 3d for so long ago (1h)");
  line.text("--to", to_, "The same (now)");
}

std::optional<CommandLine::Fault> SpanOption::read(TimeSpan& span) const {
  const UtcTime now = utc_now();
  span = {{now.nanoseconds - Duration(std::chrono::hours{1}).count()}, now};
  if (!from_.empty()) {
    const auto from = parse_time(from_, now);
    if (!from) return CommandLine::Fault{"--from", from.error()};
    span.from = *from;
  }
  if (!to_.empty()) {
    const auto to = parse_time(to_, now);
    if (!to) return CommandLine::Fault{"--to", to.error()};
    span.to = *to;
  }
  if (span.to <= span.from) return CommandLine::Fault{"--to", "the end is not after the beginning"};
  return std::nullopt;
}

}  // namespace fieldcast::cli
