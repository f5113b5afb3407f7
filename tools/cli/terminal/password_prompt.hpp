#pragma once

#include <iosfwd>
#include <string>
#include <tl/expected.hpp>

#include "bridge/base/secret.hpp"

namespace fieldcast::cli {

// First line of the file, which others must not be able to read. Without a file: prompts twice if
// `in` is std::cin and a terminal, else reads a line. The error is one human-readable line.
[[nodiscard]] tl::expected<Secret, std::string> new_password(const std::string& file,
                                                             std::istream& in,
                                                             std::ostream& prompt);

}  // namespace fieldcast::cli
