// `fieldcast poke`: writes to addresses of a device on a line, without a bridge and without a
// configuration.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "tools/cli/direct/line_options.hpp"
#include "tools/cli/exit_code.hpp"
#include "tools/cli/interrupt.hpp"

namespace fieldcast::cli {

struct PokeOptions {
  LineOptions line;
  std::vector<std::string> assignments;  // "holding:100=7", with commas for values that follow
  std::string type;                      // empty: what the address implies
  bool verify = false;
  bool trace = false;
  std::string capture;  // a new file for what passes on the line; empty: none
  bool json = false;
};

// In the order given, up to the first that is not done; everything is checked before the first.
[[nodiscard]] ExitCode poke(const PokeOptions& options, const Interrupt& interrupt,
                            std::ostream& out, std::ostream& err);

}  // namespace fieldcast::cli
