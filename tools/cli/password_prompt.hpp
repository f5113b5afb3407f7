// Reads a secret from the terminal without echo, or from a file or pipe.
#pragma once

#include <iosfwd>
#include <string>
#include <tl/expected.hpp>

#include "bridge/base/secret.hpp"

namespace fieldcast::cli {

// Returns the first line of the file, which must not be readable by other users. Without a file
// name: prompts twice if `in` is std::cin and a terminal, else reads the first line of `in`. The
// error is one human-readable line.
[[nodiscard]] tl::expected<Secret, std::string> new_password(const std::string& file,
                                                             std::istream& in,
                                                             std::ostream& prompt);

}  // namespace fieldcast::cli
