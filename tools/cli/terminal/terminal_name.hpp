// A separate file, because <term.h> defines common words as macros.
#pragma once

#include <string>

namespace fieldcast::cli {

[[nodiscard]] std::string terminal_name();

// The terminal's own name, or xterm if it is unknown. Empty if it cannot move its cursor.
[[nodiscard]] std::string usable_terminal_name();

}  // namespace fieldcast::cli
