#include "tools/sim/device/declared_word.hpp"

#include <algorithm>

#include "tools/sim/device/device.hpp"

namespace fieldcast::sim {
namespace {

using declared::Notation;
using declared::Word;

// Most significant character first: bytes, or pairs of digits if little-endian.
Bytes highest_first(ByteView characters, const Word& word) {
  Bytes turned(characters.begin(), characters.end());
  if (!word.little_endian) return turned;
  std::ranges::reverse(turned);
  if (word.notation == Notation::kHex) {
    for (std::size_t i = 0; i + 1 < turned.size(); i += 2) std::swap(turned[i], turned[i + 1]);
  }
  return turned;
}

std::optional<std::uint64_t> bcd_number(Bytes turned, const Word& word) {
  const bool negative = word.sign_bits != 0 && turned[0] >= 0x80;
  if (negative) turned[0] = static_cast<std::uint8_t>(turned[0] - 0x80);
  std::uint64_t number = 0;
  for (const std::uint8_t byte : turned) {
    if (byte >= 0xA0 || byte % 16 > 9) return std::nullopt;
    number = 100 * number + 10u * (byte / 16u) + byte % 16u;
  }
  return negative ? (~number + 1) & mask(word.sign_bits) : number;
}

Bytes bcd_characters(std::uint64_t number, const Word& word) {
  const std::uint64_t half = word.sign_bits == 0 ? 0 : std::uint64_t{1} << (word.sign_bits - 1);
  const bool negative = half != 0 && number >= half;
  if (negative) number = 2 * half - number;
  Bytes text(word.characters);
  for (std::size_t i = text.size(); i-- > 0; number /= 100)
    text[i] = static_cast<std::uint8_t>(number % 100 / 10 * 16 + number % 10);
  if (negative) text[0] = static_cast<std::uint8_t>(text[0] + 0x80);
  return text;
}

}  // namespace

std::optional<std::uint64_t> number_of(ByteView characters, const Word& word) {
  if (word.notation == Notation::kBinary) {
    std::uint64_t number = 0;
    for (std::size_t i = 0; i < characters.size(); ++i)
      number = number << 8 | characters[word.little_endian ? characters.size() - 1 - i : i];
    return number;
  }
  const Bytes turned = highest_first(characters, word);
  if (word.notation == Notation::kBcd) return bcd_number(turned, word);
  if (word.notation == Notation::kHex) return number_in(turned, 16);
  std::uint64_t number = 0;  // up to 18 digits
  for (const std::uint8_t each : turned) {
    if (each < '0' || each > '9') return std::nullopt;
    number = number * 10 + (each - '0');
  }
  return number;
}

Bytes characters_of(std::uint64_t number, const Word& word) {
  Bytes text;
  if (word.notation == Notation::kBcd) {
    text = bcd_characters(number, word);
  } else if (word.notation == Notation::kHex) {
    append_hex(text, number, word.characters);
  } else {
    const std::uint64_t base = word.notation == Notation::kDecimal ? 10 : 256;
    for (unsigned i = 0; i < word.characters; ++i, number /= base) {
      text.insert(text.begin(), static_cast<std::uint8_t>(number % base + (base == 10 ? '0' : 0)));
    }
  }
  return highest_first(text, word);  // the conversion is its own inverse
}

}  // namespace fieldcast::sim
