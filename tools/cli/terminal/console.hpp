#pragma once

#include <iosfwd>
#include <string>
#include <tl/expected.hpp>

#include "bridge/process/secret.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

[[nodiscard]] bool output_is_terminal();
// Standard output is a pipe; its reader may use the terminal, as less does.
[[nodiscard]] bool output_is_pipe();
// No size and no colour without a terminal. Honours NO_COLOR (no-color.org). Main thread.
[[nodiscard]] Screen output_screen();

// First line of the file, which others must not be able to read. Without a file: prompts twice if
// `in` is std::cin and a terminal, else reads a line.
[[nodiscard]] tl::expected<Secret, std::string> new_password(const std::string& file,
                                                             std::istream& in,
                                                             std::ostream& prompt);

}  // namespace fieldcast::cli
