// Numbers, words and encodings of lists. Pure.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <utility>
#include <vector>

#include "core/base/time.hpp"

namespace fieldcast::importing {

// The error is one line: why a text cannot be read.
template <typename T>
using Result = tl::expected<T, std::string>;
// The reason why a value cannot be moved; empty if it can.
using MayFail = std::optional<std::string>;

template <typename... Args>
[[nodiscard]] tl::unexpected<std::string> refused(fmt::format_string<Args...> why, Args&&... args) {
  return tl::unexpected(fmt::format(why, std::forward<Args>(args)...));
}

// "1.5", "1,5" (decimal comma), "1e-3", "-7", "0x1F". Empty if not finite.
[[nodiscard]] std::optional<double> number_from(std::string_view text);

// A whole number without sign: "100", "0x64", "64h", "100.0". Empty for other text.
[[nodiscard]] std::optional<std::uint64_t> whole_from(std::string_view text);
// The same from `least` to `most`.
template <typename T = std::uint64_t>
[[nodiscard]] std::optional<T> whole_from(std::string_view text, std::uint64_t least,
                                          std::uint64_t most) {
  const auto number = whole_from(text);
  if (!number || *number < least || *number > most) return std::nullopt;
  return static_cast<T>(*number);
}
// A time in ms, at least `least` and below `most`.
[[nodiscard]] std::optional<Duration> milliseconds_from(std::string_view text, double least,
                                                        double most);

struct Decoded {
  std::string text;           // UTF-8 without a byte order mark; lines end with '\n'
  std::string_view encoding;  // human-readable: "UTF-8", "UTF-16", "Windows-1252"
};

// Decodes UTF-8, UTF-16 and Windows-1252, with and without a byte order mark. If the bytes are not
// text, the error names their file type.
[[nodiscard]] Result<Decoded> decode_text(std::string_view bytes);

// Converts ASCII letters only.
[[nodiscard]] std::string lower(std::string_view text);
[[nodiscard]] std::string_view trimmed(std::string_view text);
[[nodiscard]] bool is_digit(char c);
[[nodiscard]] bool all_digits(std::string_view text);  // false for an empty text
[[nodiscard]] bool contains(std::string_view text, std::string_view part);
[[nodiscard]] std::vector<std::string_view> split(std::string_view text, char separator);
// Splits at the first separator; the second part is empty without one.
[[nodiscard]] std::pair<std::string_view, std::string_view> halves(std::string_view text,
                                                                   char separator);

using Replacement = std::pair<std::string_view, std::string_view>;
// Replaces each first text by its second, one row after the other.
[[nodiscard]] std::string with_replaced(std::string_view text, std::span<const Replacement> rows);

// Whether `word` is one of `words`, which are separated by single blanks.
[[nodiscard]] bool is_one_of(std::string_view word, std::string_view words);

template <typename T>
struct Words {
  std::string_view words;  // separated by single blanks
  T value;
};

template <typename T, std::size_t N>
[[nodiscard]] std::optional<T> value_of(const Words<T> (&table)[N], std::string_view word) {
  for (const Words<T>& row : table) {
    if (is_one_of(word, row.words)) return row.value;
  }
  return std::nullopt;
}

}  // namespace fieldcast::importing
