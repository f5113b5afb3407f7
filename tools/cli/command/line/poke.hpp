#pragma once

#include <string>
#include <vector>

#include "tools/cli/command/base/command.hpp"
#include "tools/cli/direct/direct_bus.hpp"
#include "tools/cli/terminal/interrupt.hpp"

namespace fieldcast::cli {

struct PokeOptions {
  LineOptions line;
  std::vector<std::string> assignments;  // "holding:100=7"; commas separate consecutive values
  std::string type;                      // empty: default of the address
  bool verify = false;
  bool trace = false;
  std::string capture;  // new capture file; empty: none
  bool json = false;
};

// Checks all assignments first, then writes in order until one fails.
[[nodiscard]] ExitCode poke(const PokeOptions& options, const Interrupt& interrupt,
                            const Streams& to);

}  // namespace fieldcast::cli
