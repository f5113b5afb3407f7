// Numbers as the characters of a declared word, for the device. Independent of the bridge's codec.
// Pure functions.
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/bytes.hpp"
#include "core/protocol/declared/word.hpp"

namespace fieldcast::sim {

[[nodiscard]] constexpr std::uint64_t mask(unsigned bits) {
  return bits >= 64 ? UINT64_MAX : (std::uint64_t{1} << bits) - 1;
}

// Characters of the number at the start, with its sign if it is of variable width.
[[nodiscard]] std::size_t number_length(ByteView characters, const declared::Word& word);

// Empty if a character is not a digit, or if a number of variable width does not fit.
[[nodiscard]] std::optional<std::uint64_t> number_of(ByteView characters,
                                                     const declared::Word& word);
[[nodiscard]] Bytes characters_of(std::uint64_t number, const declared::Word& word);

}  // namespace fieldcast::sim
