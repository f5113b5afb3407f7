// The life of fieldcast-bridge: start, signals, stop. Main thread.
#pragma once

#include <string>

#include "bridge/exit_code.hpp"

namespace fieldcast {

struct DaemonOptions {
  std::string configuration;  // path
  bool trace = false;         // wire trace from the start
};

// Prints every fault of the file, or a summary of what it configures.
[[nodiscard]] ExitCode check_configuration(const std::string& path);

// Runs until SIGTERM or SIGINT. SIGHUP reloads the file, SIGUSR1 switches the wire trace on and
// off. REQUIRES: no other thread runs yet, since signals are blocked in all that follow.
[[nodiscard]] ExitCode run_daemon(const DaemonOptions& options);

}  // namespace fieldcast
