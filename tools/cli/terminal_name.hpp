// Which description of terminals fits this one. A file of its own, as <term.h> makes macros of
// common words.
#pragma once

#include <string>

namespace fieldcast::cli {

// TERM as the environment has it.
[[nodiscard]] std::string terminal_name();

// The terminal's own name, or that of xterm, which nearly every terminal follows, where this
// machine does not know it. Empty: it cannot move its cursor.
[[nodiscard]] std::string usable_terminal_name();

}  // namespace fieldcast::cli
