#pragma once

#include "tools/cli/view/text_table.hpp"

namespace fieldcast::cli {

// output_screen() is zero without a terminal. NO_COLOR is honoured (no-color.org).
[[nodiscard]] bool output_is_terminal();
// Standard output is a pipe; its reader may use the terminal, as less does.
[[nodiscard]] bool output_is_pipe();
[[nodiscard]] Screen output_screen();

}  // namespace fieldcast::cli
