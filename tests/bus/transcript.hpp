// Transcript of a bus engine: times, bytes, events, and the actions of the engine. The file is both
// input and expectation: a replay of its events must reproduce the file.
//
//     bus: { ... }                       a configuration, up to a line of three hyphens
//     ---
//     0        opened
//     1.75ms   >> 01 03 00 64 00 02 85 D4          sent
//     +4ms     << 01 03 04 41 20 00 00 EF CF       received, this long after the request
//     6ms      sample press-1/oil-temperature = 10 GOOD
//     7ms      command c1 write press-1/setpoint = 5 verify expires 2s
//     9ms      result c1 done
//
// "+4ms" counts from the next request without a response ("+0 lost": it never gets one), "++4ms"
// from the previous event. Blank lines and lines that begin with # are kept.
#pragma once

#include <string>

namespace fieldcast::test {

// Returns the real actions of the engine for the events of `text`: the same text if the engine is
// correct. An invalid line is replaced by "!! ...".
[[nodiscard]] std::string replay(const std::string& text);

}  // namespace fieldcast::test
