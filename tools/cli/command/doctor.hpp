// `fieldcast doctor [CONFIG]`: what of this machine keeps Fieldcast from running well, and what to
// do. Needs no bridge. With a configuration it listens in its domain for the clocks of bridges.
#pragma once

#include <iosfwd>
#include <string>

#include "tools/cli/exit_code.hpp"
#include "tools/cli/view/text_table.hpp"

namespace fieldcast::cli {

struct DoctorOptions {
  std::string config;      // empty: the machine alone
  std::string root = "/";  // where its files lie
  bool json = false;
  bool listens = false;  // in the domain of the configuration
  std::string security;  // the folder of a member, to join with; empty: that of the configuration
};

// kOk, kFound when something of the configuration cannot run, kUsage when the file has faults.
[[nodiscard]] ExitCode doctor(const DoctorOptions& options, std::ostream& out, std::ostream& err,
                              const Screen& screen);

}  // namespace fieldcast::cli
