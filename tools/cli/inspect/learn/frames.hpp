// Columns and numbers of a set of frames. Pure functions. A position below 0 counts from the end.
#pragma once

#include <cstddef>
#include <optional>
#include <set>
#include <vector>

#include "core/base/bytes.hpp"
#include "core/protocol/declared/declaration.hpp"

namespace fieldcast::learn {

using Frames = std::vector<ByteView>;

struct Evidence {
  std::size_t holds = 0, of = 0;  // frames
  // Captures contain refusals and broken frames: one in ten frames may differ.
  [[nodiscard]] bool holds_mostly() const { return of > 0 && holds * 10 >= of * 9; }
  void add(bool held) { ++of, holds += held ? 1 : 0; }
};

// Empty beyond the frame.
[[nodiscard]] ByteView columns_of(ByteView frame, std::ptrdiff_t at, std::size_t width);
[[nodiscard]] std::optional<std::uint8_t> byte_at(ByteView frame, std::ptrdiff_t at);
// Empty beyond the frame, or if a character is not a digit.
[[nodiscard]] std::optional<std::uint64_t> number_at(ByteView frame, std::ptrdiff_t at,
                                                     const declared::Word& word);

// The values of the columns at .. end-1; frames that end before do not count. An end of 0 is that
// of the frame.
[[nodiscard]] std::set<std::uint8_t> values_in(const Frames& frames, std::ptrdiff_t at,
                                               std::ptrdiff_t end);
[[nodiscard]] inline std::set<std::uint8_t> values_at(const Frames& frames, std::ptrdiff_t at) {
  return values_in(frames, at, at + 1);
}
// Different values of the columns at .. end-1.
[[nodiscard]] std::size_t different(const Frames& frames, std::ptrdiff_t at, std::ptrdiff_t end);
// The byte that nearly all frames have there.
[[nodiscard]] std::optional<std::uint8_t> constant_at(const Frames& frames, std::ptrdiff_t at);
// Of this many last characters that are constant.
[[nodiscard]] std::size_t constant_end(const Frames& frames, std::size_t most);
[[nodiscard]] std::size_t shortest(const Frames& frames);
[[nodiscard]] std::size_t longest(const Frames& frames);

[[nodiscard]] bool is_text(const Frames& frames);
// Each character of the columns at .. end-1 is a digit of the base 10 or 16.
[[nodiscard]] bool are_digits(const Frames& frames, std::ptrdiff_t at, std::ptrdiff_t end,
                              int base);

// The numbers that may be added to each byte, if all are packed decimal digits then.
[[nodiscard]] std::set<std::uint8_t> packed_adds(const std::set<std::uint8_t>& values);

[[nodiscard]] inline declared::Word binary(std::size_t bytes, bool little_endian = false) {
  return {declared::Notation::kBinary, static_cast<std::uint8_t>(bytes), little_endian};
}
[[nodiscard]] inline declared::Word digits(declared::Notation notation, std::size_t count) {
  return {notation, static_cast<std::uint8_t>(count)};
}
// Of a text, decimal digits if no digit is above 9.
[[nodiscard]] declared::Word word_at(const Frames& frames, std::ptrdiff_t at, std::size_t width,
                                     bool text);

}  // namespace fieldcast::learn
