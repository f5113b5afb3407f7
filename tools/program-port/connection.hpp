// One connection of a local port to a device behind a bridge, as the command line describes it.
#pragma once

#include <optional>
#include <string>

#include "bridge/process/command_line.hpp"

namespace fieldcast::port {

enum ExitCode : int {
  kStopped = 0,
  kTrouble = 1,
  kUsage = 2,
  kRefused = 3,
  kNoPort = 4,
  kBridgeGone = 5,
  kDeviceLost = 6
};

struct Connection {
  std::string server, device, port, line, log, user, password_file, authorities, certificate, key;
  std::string heartbeat = "5s";
  std::uint32_t baud = 0;  // 0: not given
  bool tls = false, markers = false, json = false, reconnect = false;
};

void describe_connection(CommandLine& line, Connection& given);
// The options of run_list(). Returns `--server`.
CommandLine::Option describe_list(CommandLine& line, Connection& given);

// Empty if the options are valid and their files are usable.
[[nodiscard]] std::optional<std::string> fault_of(const Connection& given);

// Connects until the session ends. Reports to standard output and to the log file.
[[nodiscard]] ExitCode run_connection(const Connection& given);

// Prints the devices that the bridge lists. Uses the options of the bridge, the login and `json`.
[[nodiscard]] ExitCode run_list(const Connection& given);

}  // namespace fieldcast::port
