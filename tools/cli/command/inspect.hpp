// `fieldcast inspect PROTOCOL HEX`: a frame for people. PROTOCOL is built in, the path of a
// declaration, or the name of one that comes with Fieldcast. Needs no DDS.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "tools/cli/exit_code.hpp"
#include "tools/cli/view/text_table.hpp"

namespace fieldcast::cli {

struct InspectOptions {
  std::string protocol;
  std::vector<std::string> hex;  // empty: from `in`
  bool json = false;
};

// kOk, kFound when the frame has a fault, kUsage for an unknown protocol or what is no hexadecimal.
[[nodiscard]] ExitCode inspect(const InspectOptions& options, std::istream& in, std::ostream& out,
                               std::ostream& err, const Screen& screen);

}  // namespace fieldcast::cli
