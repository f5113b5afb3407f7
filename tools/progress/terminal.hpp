// The terminal of a program. Any thread.
#pragma once

#include <cstddef>

namespace fieldcast {

// True if the descriptor is a terminal that interprets escape sequences.
[[nodiscard]] bool is_terminal(int fd);

// Returns the columns of a line of the terminal; 0 if unknown.
[[nodiscard]] std::size_t terminal_columns(int fd);

}  // namespace fieldcast
