// Makes untrusted text safe for a screen and fits it to columns. Pure functions; nothing fails.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

// Escapes as core/base/message_text.hpp, and direction marks, right-to-left letters and characters
// without a known width, as \u{5D0}. A character keeps at most two combining marks.
[[nodiscard]] std::string shown(std::string_view text);

// Columns in a terminal; a wide character has two. REQUIRES: the text comes from shown().
[[nodiscard]] std::size_t columns_of(std::string_view shown);

[[nodiscard]] std::string cut(std::string_view shown, std::size_t columns);

// Pads with spaces, or truncates with `~`.
[[nodiscard]] std::string fitted(std::string_view shown, std::size_t columns,
                                 Align align = Align::kLeft);

// Wraps at spaces if possible; indents every line but the first. At least one line.
[[nodiscard]] std::vector<std::string> wrapped(std::string_view shown, std::size_t columns,
                                               std::size_t indent = 0);

}  // namespace fieldcast::cli
