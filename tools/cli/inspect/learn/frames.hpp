// Columns and numbers of a set of frames. Pure functions. A position below 0 counts from the end.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/base/bytes.hpp"
#include "core/protocol/declared/declaration.hpp"

namespace fieldcast::learn {

using Frames = std::vector<ByteView>;

struct Evidence {
  std::size_t holds = 0, of = 0;  // frames
  // Captures contain refusals and broken frames: one in ten frames may differ.
  [[nodiscard]] bool holds_mostly() const { return of > 0 && holds * 10 >= of * 9; }
};

[[nodiscard]] std::optional<std::uint8_t> byte_at(ByteView frame, std::ptrdiff_t at);
// Empty beyond the frame, or if a character is not a digit.
[[nodiscard]] std::optional<std::uint64_t> number_at(ByteView frame, std::ptrdiff_t at,
                                                     const declared::Word& word);

// The values of a column; frames that end before it do not count.
[[nodiscard]] std::set<std::uint8_t> values_at(const Frames& frames, std::ptrdiff_t at);
// The byte that nearly all frames have there.
[[nodiscard]] std::optional<std::uint8_t> constant_at(const Frames& frames, std::ptrdiff_t at);
// Of this many last characters that are constant.
[[nodiscard]] std::size_t constant_end(const Frames& frames, std::size_t most);
[[nodiscard]] std::size_t shortest(const Frames& frames);
[[nodiscard]] std::size_t longest(const Frames& frames);

[[nodiscard]] bool is_text(const Frames& frames);
[[nodiscard]] constexpr bool is_decimal_digit(std::uint8_t c) { return c >= '0' && c <= '9'; }

[[nodiscard]] inline declared::Word binary(unsigned bytes, bool little_endian = false) {
  return {declared::Notation::kBinary, static_cast<std::uint8_t>(bytes), little_endian};
}
[[nodiscard]] inline declared::Word digits(declared::Notation notation, std::size_t count) {
  return {notation, static_cast<std::uint8_t>(count)};
}

}  // namespace fieldcast::learn
