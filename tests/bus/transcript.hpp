// A run of a bus engine as a text of instants, bytes, events and actions. The file is both input
// and expectation: replaying its events must produce the same file.
//
//    bus: { ... }                       a configuration, up to a line of three hyphens
//    ---
//    0        opened
//    1.75ms   >> 01 03 00 64 00 02 85 D4          sent
//    +4ms     << 01 03 04 41 20 00 00 EF CF       received, this long after the request
//    6ms      sample press-1/oil-temperature = 10 GOOD
//    7ms      command c1 write press-1/setpoint = 5 verify expires 2s
//    9ms      result c1 done
//
// After "0 trace", each request is followed by "asks ..." and traces by "traced ...". "+4ms" counts
// from the next request without a response ("+0 lost": it gets no response), "++4ms" from the
// previous event. Blank lines and lines that begin with # are kept.
#pragma once

#include <string>

namespace fieldcast::test {

// Replays the events of `text` and returns the transcript with the actual actions. It equals `text`
// if the engine behaves as expected. An invalid line is replaced by "!! ...".
[[nodiscard]] std::string replay(const std::string& text);

}  // namespace fieldcast::test
