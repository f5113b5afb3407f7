// A secret from whoever sits at the terminal, without an echo; or from a file or a pipe.
#pragma once

#include <iosfwd>
#include <string>
#include <tl/expected.hpp>

#include "bridge/base/secret.hpp"

namespace fieldcast::cli {

// The first line of the file, which nobody else may read. Without a file name: asked for twice when
// `in` is std::cin and that is a terminal, else the first line of `in`. The fault is a line for
// people.
[[nodiscard]] tl::expected<Secret, std::string> new_password(const std::string& file,
                                                             std::istream& in,
                                                             std::ostream& prompt);

}  // namespace fieldcast::cli
