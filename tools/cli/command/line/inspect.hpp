// `fieldcast inspect`: explains a frame in hexadecimal, lines of a trace, or a capture. PROTOCOL: a
// built-in name, the path of a declaration, or the name of an installed one. Needs no DDS.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "core/base/json.hpp"
#include "tools/cli/text/output.hpp"
#include "tools/sim/check/sim_check.hpp"

namespace fieldcast::cli {

struct InspectOptions {
  std::string protocol;          // or the path of a capture; empty: from the configuration
  std::vector<std::string> hex;  // or lines of a trace; empty: read from `in`
  bool json = false;
  std::string config;   // used to decode values; empty: no decoding
  bool fields = false;  // prints every field of each frame of a capture or trace
};

// Returns kFound if a frame is invalid or a capture is truncated, kUsage for invalid input.
[[nodiscard]] ExitCode inspect(const InspectOptions& options, std::istream& in, std::ostream& out,
                               std::ostream& err, const Screen& screen);

// `fieldcast sim-check PROTOCOL`: tests a protocol's master against its simulated device in virtual
// time. PROTOCOL as for `inspect`. Needs no DDS.

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
