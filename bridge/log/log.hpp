// The log: lines on stderr with a time, a level and a subject ("press-shop/press-1"), and the wire
// trace. Everything here may be called from any thread and never waits for the reader of the lines.
// Callers never hand in secrets: what is passed is written. One line stays one line, whatever text
// from outside is in it (core/base/printable.hpp). Where the journal reads stderr
// ($JOURNAL_STREAM), a line begins with its syslog priority, "<4>", and has no time: the journal
// keeps both.
#pragma once

#include <string>
#include <string_view>

#include "core/base/bytes.hpp"
#include "core/base/time.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

// Before the first line; level is the least that is written.
void open_log(LogLevel level);
// The log keeps the stderr of its first line. After this call it writes to the one of now, and
// counts from the start (log_counted). For tests that capture stderr.
void reopen_log();
void log_line(LogLevel level, std::string_view subject, std::string_view text);

inline void log_debug(std::string_view subject, std::string_view text) {
  log_line(LogLevel::kDebug, subject, text);
}
inline void log_info(std::string_view subject, std::string_view text) {
  log_line(LogLevel::kInfo, subject, text);
}
inline void log_warning(std::string_view subject, std::string_view text) {
  log_line(LogLevel::kWarning, subject, text);
}
inline void log_error(std::string_view subject, std::string_view text) {
  log_line(LogLevel::kError, subject, text);
}

// A line that outsiders can cause as often as they like: the first few of a kind are written, what
// comes beyond is counted (LineBudget). `kind` is one of a small fixed number of names, said in the
// summary: "refused interests".
void log_counted(LogLevel level, std::string_view subject, std::string_view kind,
                 std::string_view text);
// Summaries of what was only counted; asked now and then.
void log_summaries(Instant now);

// Waits until what was logged and traced so far is written, or until the limit. Lines that a stream
// has not taken by then are lost.
void flush_log(Duration limit);

// One line of the wire trace on stdout:
//     2024-05-01T10:00:00.000123Z press-shop >> 01 03 00 01 00 01 D5 CA
enum class TraceMark { kSent, kReceived, kRemark };  // ">>", "<<", "--"
void trace_line(UtcTime at, std::string_view bus, TraceMark mark, std::string_view text);

}  // namespace fieldcast
