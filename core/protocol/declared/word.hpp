// A number on the wire: binary bytes, or a fixed number of ASCII digits. Pure functions.
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/bytes.hpp"

namespace fieldcast::declared {

enum class Notation : std::uint8_t {
  kBinary,
  kHex,  // upper-case digits, two per byte
  kDecimal,
};

struct Word {
  Notation notation = Notation::kBinary;
  std::uint8_t characters = 1;  // on the wire: 1..8 bytes, 1..16 hex digits, 1..18 decimal digits
  bool little_endian = false;   // lowest byte first, also for pairs of hex digits
  friend bool operator==(const Word&, const Word&) = default;
};

[[nodiscard]] std::uint64_t largest(const Word& word);

void append_word(Bytes& out, const Word& word, std::uint64_t number);

// Empty if a character is not a digit. REQUIRES: characters.size() == word.characters.
[[nodiscard]] std::optional<std::uint64_t> read_word(ByteView characters, const Word& word);

[[nodiscard]] bool could_begin(ByteView characters, const Word& word);

}  // namespace fieldcast::declared
