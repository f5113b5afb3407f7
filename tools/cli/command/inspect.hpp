// `fieldcast inspect`: frames for people. A frame in hexadecimal, pasted lines of a bridge's trace,
// or a capture. PROTOCOL is built in, the path of a declaration, or the name of one that comes with
// Fieldcast; a capture and a configuration say it themselves. Needs no DDS.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "tools/cli/exit_code.hpp"
#include "tools/cli/view/text_table.hpp"

namespace fieldcast::cli {

struct InspectOptions {
  std::string protocol;          // or the path of a capture; empty: the configuration says it
  std::vector<std::string> hex;  // or text lines of a trace; empty: from `in`
  bool json = false;
  std::string config;   // decodes values by it; empty: by none
  bool fields = false;  // every field of each frame of a capture or a trace
};

// kOk, kFound when a frame has a fault or a capture is cut, kUsage for an unknown protocol or what
// is neither hexadecimal nor a trace nor a capture.
[[nodiscard]] ExitCode inspect(const InspectOptions& options, std::istream& in, std::ostream& out,
                               std::ostream& err, const Screen& screen);

}  // namespace fieldcast::cli
