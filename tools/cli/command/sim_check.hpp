// `fieldcast sim-check PROTOCOL`: a protocol's master against its simulated device, through the
// whole matrix, in virtual time. PROTOCOL is built in, the path of a declaration, or the name of
// one that comes with Fieldcast. Needs no DDS.
#pragma once

#include <iosfwd>
#include <string>

#include "core/base/json.hpp"
#include "tools/cli/exit_code.hpp"
#include "tools/cli/view/text_table.hpp"
#include "tools/sim/check/check_report.hpp"

namespace fieldcast::cli {

struct SimCheckOptions {
  std::string protocol;
  bool json = false;
};

// kOk, kFound when anything failed, kUsage for an unknown protocol or a declaration at fault.
[[nodiscard]] ExitCode sim_check(const SimCheckOptions& options, std::ostream& out,
                                 std::ostream& err, const Screen& screen);

[[nodiscard]] Json check_json(std::string_view protocol, const sim::CheckRow& row);
// A table of the rows, then every failure that was kept, with its frame.
[[nodiscard]] std::vector<std::string> check_lines(const sim::CheckRows& rows,
                                                   const Screen& screen);

}  // namespace fieldcast::cli
