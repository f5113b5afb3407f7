// Text of others on a screen of cells: what it may contain, how many columns it takes, and how it
// is made to fit. Pure functions; any thread; nothing fails.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "tools/cli/view/text_table.hpp"

namespace fieldcast::cli {

// As core/base/escaped.hpp, and besides: characters that change the direction of text, letters
// written from right to left, characters without a width and characters that no terminal knows
// appear as \u{5D0}. After it, each character takes the columns that columns_of() counts. Two
// combining marks at most stay on one character.
[[nodiscard]] std::string shown(std::string_view text);

// Columns in a terminal; a wide character takes two. REQUIRES: the text comes from shown().
[[nodiscard]] std::size_t columns_of(std::string_view shown);

// The beginning that fits the columns; a wide character is never halved.
[[nodiscard]] std::string cut(std::string_view shown, std::size_t columns);

// Exactly so many columns: filled with spaces, or cut with `~` as its last column.
[[nodiscard]] std::string fitted(std::string_view shown, std::size_t columns,
                                 Align align = Align::kLeft);

// Lines of at most so many columns, broken at spaces where there are any; every line but the first
// begins with `indent` spaces. One line at least.
[[nodiscard]] std::vector<std::string> wrapped(std::string_view shown, std::size_t columns,
                                               std::size_t indent = 0);

}  // namespace fieldcast::cli
