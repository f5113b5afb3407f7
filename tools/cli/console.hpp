// The terminal, if there is one: its size and its colours. Main thread.
#pragma once

#include "tools/cli/view/text_table.hpp"

namespace fieldcast::cli {

// Standard output as it is now: zero bounds and no colour when it is no terminal; NO_COLOR is
// honoured (no-color.org).
[[nodiscard]] bool output_is_terminal();
// Standard output goes to a program, which may have the terminal for itself, as less has.
[[nodiscard]] bool output_is_pipe();
[[nodiscard]] Screen output_screen();

}  // namespace fieldcast::cli
