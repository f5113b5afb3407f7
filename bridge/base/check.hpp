// An assertion in every build: a violated internal rule ends the process with file and line.
#pragma once

namespace fieldcast {

// Writes the rule to standard error if writable within 100 ms, and ends the process.
[[noreturn]] void end_for_broken_rule(const char* file, int line, const char* condition);

}  // namespace fieldcast

#define FIELDCAST_CHECK(condition)                                      \
  do {                                                                  \
    if (!(condition)) [[unlikely]]                                      \
      ::fieldcast::end_for_broken_rule(__FILE__, __LINE__, #condition); \
  } while (false)
