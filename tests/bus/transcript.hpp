// A bus engine's day as a text: instants, bytes, events, and what the engine did. The file is input
// and expectation in one; replaying its events must give back the file itself.
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
// "+4ms" counts from the next request that nothing answered yet ("+0 lost": and nothing will),
// "++4ms" from the event before. Blank lines and lines that begin with # are kept as they are.
#pragma once

#include <string>

namespace fieldcast::test {

// What the engine really does when the events of `text` happen: the same text when it behaves. A
// line that is not understood is answered with "!! ..." in its place.
[[nodiscard]] std::string replay(const std::string& text);

}  // namespace fieldcast::test
