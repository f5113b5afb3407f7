// `fieldcast inspect --learn`: reads frames and prints a declaration for them. Main thread.
#pragma once

#include "tools/cli/command/line/inspect.hpp"

namespace fieldcast::cli {

// The output is a declaration, with the evidence for each field as comments, or JSON lines.
[[nodiscard]] ExitCode learn_protocol(const InspectOptions& options, const Streams& to);

}  // namespace fieldcast::cli
