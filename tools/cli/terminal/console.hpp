#pragma once

#include "tools/cli/text/text_table.hpp"

namespace fieldcast::cli {

[[nodiscard]] bool output_is_terminal();
// Standard output is a pipe; its reader may use the terminal, as less does.
[[nodiscard]] bool output_is_pipe();
// No size and no colour without a terminal. Honours NO_COLOR (no-color.org). Main thread.
[[nodiscard]] Screen output_screen();

}  // namespace fieldcast::cli
