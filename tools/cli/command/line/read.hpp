#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/cli/command/base/command.hpp"
#include "tools/cli/direct/direct_bus.hpp"
#include "tools/cli/terminal/interrupt.hpp"

namespace fieldcast::cli {

struct ReadOptions {
  LineOptions line;
  std::vector<std::string> addresses;
  std::uint32_t count = 1;  // values at each address
  std::string type;         // empty: default of the address
  std::string as;           // "float32,int32", "all": types for --as
  bool trace = false;
  std::string capture;  // new capture file; empty: none
  bool json = false;
};

// Continues after a refused address; returns the code of the last fault.
[[nodiscard]] ExitCode read(const ReadOptions& options, const Interrupt& interrupt,
                            const Streams& to);

}  // namespace fieldcast::cli
