// The log on stderr, each line with time, level and subject ("press-shop/press-1"), and the wire
// trace. Any thread; no call waits for the reader. Never pass secrets. Line breaks in texts from
// outside are escaped. For the journal ($JOURNAL_STREAM), a line begins with its syslog priority,
// "<4>", and has no time.
#pragma once

#include <string>
#include <string_view>

#include "core/base/bytes.hpp"
#include "core/base/time.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

// Call before the first line. `level` is the lowest level that is written.
void open_log(LogLevel level);
// Switches to the present stderr and resets the counts of log_counted(), for tests.
void reopen_log();
void log_line(LogLevel level, std::string_view subject, std::string_view text);

inline void log_info(std::string_view subject, std::string_view text) {
  log_line(LogLevel::kInfo, subject, text);
}
inline void log_warning(std::string_view subject, std::string_view text) {
  log_line(LogLevel::kWarning, subject, text);
}
inline void log_error(std::string_view subject, std::string_view text) {
  log_line(LogLevel::kError, subject, text);
}

// For lines that outsiders can cause without limit: writes the first ones of a kind and counts the
// rest (LineBudget). `kind` is one of few fixed names, as in the summary: "refused interests".
void log_counted(LogLevel level, std::string_view subject, std::string_view kind,
                 std::string_view text);
// Writes the summaries of counted lines; call periodically.
void log_summaries(Instant now);

// Waits until all earlier lines are written. Those unwritten after the limit are lost.
void flush_log(Duration limit);

// Writes one line of the wire trace to stdout:
//     2024-05-01T10:00:00.000123Z press-shop >> 01 03 00 01 00 01 D5 CA
enum class TraceMark { kSent, kReceived, kRemark };  // ">>", "<<", "--"
void trace_line(UtcTime at, std::string_view bus, TraceMark mark, std::string_view text);

}  // namespace fieldcast
