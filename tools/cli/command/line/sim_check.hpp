// `fieldcast sim-check PROTOCOL`: tests a protocol's master against its simulated device in virtual
// time. PROTOCOL as for `inspect`. Needs no DDS.
#pragma once

#include <iosfwd>
#include <string>

#include "core/base/json.hpp"
#include "tools/cli/text/exit_code.hpp"
#include "tools/cli/text/text_table.hpp"
#include "tools/sim/check/check_report.hpp"

namespace fieldcast::cli {

struct SimCheckOptions {
  std::string protocol;
  bool json = false;
};

// Returns kFound if a check failed, kUsage for an unknown protocol or an invalid declaration.
[[nodiscard]] ExitCode sim_check(const SimCheckOptions& options, std::ostream& out,
                                 std::ostream& err, const Screen& screen);

[[nodiscard]] Json check_json(std::string_view protocol, const sim::CheckRow& row);
[[nodiscard]] std::vector<std::string> check_lines(const sim::CheckRows& rows,
                                                   const Screen& screen);

}  // namespace fieldcast::cli
