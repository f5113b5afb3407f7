// `fieldcast doctor [CONFIG]`: finds problems of this machine, without a bridge and DDS.
#pragma once

#include <iosfwd>
#include <string>

#include "tools/cli/text/exit_code.hpp"
#include "tools/cli/text/text_table.hpp"

namespace fieldcast::cli {

struct DoctorOptions {
  std::string config;      // empty: checks only the machine
  std::string root = "/";  // root of the file system
  bool json = false;
  bool listens = false;  // in the domain of the configuration
  std::string security;  // the folder of a member, to join with; empty: that of the configuration
};

// Returns kFound if part of the configuration cannot run, kUsage if the file has faults.
[[nodiscard]] ExitCode doctor(const DoctorOptions& options, std::ostream& out, std::ostream& err,
                              const Screen& screen);

}  // namespace fieldcast::cli
