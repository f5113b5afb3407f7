// The daemon fieldcast-bridge: start, signals, stop. Main thread.
#pragma once

#include <string>

#include "bridge/base/exit_code.hpp"

namespace fieldcast {

struct DaemonOptions {
  std::string configuration;
  bool trace = false;
};

// Prints every fault of the file, or a summary of the configuration.
[[nodiscard]] ExitCode check_configuration(const std::string& path);

// Runs until SIGTERM or SIGINT. SIGHUP reloads the file; SIGUSR1 switches the wire trace. REQUIRES:
// no other thread runs yet, because only threads created later inherit the signal mask.
[[nodiscard]] ExitCode run_daemon(const DaemonOptions& options);

}  // namespace fieldcast
