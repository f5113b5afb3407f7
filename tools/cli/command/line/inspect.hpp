// PROTOCOL: a built-in name, the path of a declaration, or the name of an installed one.
#pragma once

#include <string>
#include <vector>

#include "tools/cli/command/base/command.hpp"

namespace fieldcast::cli {

struct InspectOptions {
  std::string protocol;          // or the path of a capture; empty: from the configuration
  std::vector<std::string> hex;  // or lines of a trace; empty: read from `in`
  bool json = false;
  std::string config;   // used to decode values; empty: no decoding
  bool fields = false;  // prints every field of each frame of a capture or trace
  bool learn = false;   // proposes a declaration; `protocol` is a file, or empty
};

// Returns kFound if a frame is invalid, a capture is truncated or no operation is learned, kUsage
// for invalid input.
[[nodiscard]] ExitCode inspect(const InspectOptions& options, const Streams& to);

}  // namespace fieldcast::cli
