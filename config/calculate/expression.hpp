// The expression of a calculated channel as text: names of channels, numbers, operators, functions.
// Pure. Untrusted text: its length, its nesting and the number of its names have limits.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "core/model/calculation.hpp"

namespace fieldcast::config {

inline constexpr std::size_t kMaxInputs = 32;
inline constexpr std::size_t kMaxBracketDepth = 16;

struct ExpressionFault {
  std::size_t at = 0;  // byte of the expression
  std::string what, allowed{}, suggestion{};
};

struct Expression {
  struct Name {
    std::string text;    // "voltage", "line-2/meter/current"
    std::size_t at = 0;  // first use
  };
  std::vector<Name> names;  // the inputs, each once
  std::string code;         // the text with variables instead of the names, at the same bytes
  // Names that + or - combines, as indexes.
  std::vector<std::pair<std::size_t, std::size_t>> sums;
};

// A name is written as it is if it has only letters, digits and '_', otherwise in braces.
[[nodiscard]] tl::expected<Expression, ExpressionFault> parse_expression(std::string_view text);
[[nodiscard]] std::string as_written(std::string_view name);

// Fails if the order of the operators, brackets and arguments is wrong.
[[nodiscard]] tl::expected<Formula, ExpressionFault> compile(const Expression& expression);

// "abs, acos, ...".
[[nodiscard]] std::string function_names();

}  // namespace fieldcast::config
