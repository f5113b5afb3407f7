#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/time.hpp"
#include "tools/cli/command/base/command.hpp"
#include "tools/cli/terminal/interrupt.hpp"

namespace fieldcast::cli {

struct ScanOptions {
  std::string port;
  std::vector<std::string> protocols;  // empty: modbus-rtu, for HOST:PORT modbus-tcp
  std::optional<std::uint32_t> baud;
  std::string format;
  std::string addresses = "1-32";
  std::optional<Duration> timeout;  // for each response; disables the quick search
  bool all = false;                 // searches every line; disables the quick search
  std::string out;                  // new configuration file; must not exist
  std::string capture;              // new capture file; empty: none
  bool json = false;
};

// Also shows what was found before an interrupt.
[[nodiscard]] ExitCode scan(const ScanOptions& options, const Interrupt& interrupt,
                            const Streams& to);

}  // namespace fieldcast::cli
