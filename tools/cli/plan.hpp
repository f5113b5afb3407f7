// `fieldcast plan CONFIG`: what the wire will have to carry, before anything is connected. Needs no DDS.
#pragma once

#include <iosfwd>
#include <string>

#include "tools/cli/exit_code.hpp"

namespace fieldcast::cli {

struct PlanOptions {
  std::string config;
  bool json = false;
};

// kOk, kFound when some bus cannot keep its promises, kUsage when the file has faults.
[[nodiscard]] ExitCode plan(const PlanOptions& options, std::ostream& out, std::ostream& err);

}  // namespace fieldcast::cli
