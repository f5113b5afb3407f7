// Selects the terminal description. A separate file, because <term.h> defines common words as
// macros.
#pragma once

#include <string>

namespace fieldcast::cli {

// TERM of the environment.
[[nodiscard]] std::string terminal_name();

// Returns the terminal's own name, or xterm if this machine does not know it. Empty: it cannot move
// its cursor.
[[nodiscard]] std::string usable_terminal_name();

}  // namespace fieldcast::cli
