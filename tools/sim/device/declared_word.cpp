#include "tools/sim/device/declared_word.hpp"

#include <fmt/format.h>

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

// Added to the byte with the highest digits of a negative BCD number.
std::uint8_t minus_of(const Word& word) { return word.sign_digit ? 0xF0 : 0x80; }

std::optional<std::uint64_t> bcd_number(Bytes turned, const Word& word) {
  const bool negative = word.sign_bits != 0 && turned[0] >= minus_of(word);
  if (negative) turned[0] = static_cast<std::uint8_t>(turned[0] - minus_of(word));
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
  if (negative) text[0] = static_cast<std::uint8_t>(text[0] + minus_of(word));
  return text;
}

}  // namespace

namespace {

bool is_digit(std::uint8_t c, Notation notation) {
  return (c >= '0' && c <= '9') || (notation == Notation::kHex && c >= 'A' && c <= 'F');
}

// The sign and the digits of a number of variable width.
std::optional<std::uint64_t> free_number(ByteView characters, const Word& word) {
  const bool negative = !characters.empty() && characters[0] == '-';
  if (negative || (!characters.empty() && characters[0] == '+')) characters = characters.subspan(1);
  if (characters.empty() || characters.size() > word.characters) return std::nullopt;
  std::uint64_t number = 0;
  for (const std::uint8_t c : characters) {
    if (!is_digit(c, word.notation)) return std::nullopt;
    number = number * (word.notation == Notation::kHex ? 16 : 10) +
             static_cast<std::uint64_t>(c <= '9' ? c - '0' : c - 'A' + 10);
  }
  if (word.sign_bits == 0) return number;
  const std::uint64_t half = std::uint64_t{1} << (word.sign_bits - 1);
  if (number > half || (number == half && !negative)) return std::nullopt;
  return negative ? (~number + 1) & mask(word.sign_bits) : number;
}

// 100 * channel + place.
std::optional<std::uint64_t> item_of_channel(std::optional<std::uint64_t> digits) {
  if (!digits || *digits % 100 > 15) return std::nullopt;
  return *digits / 100 * 16 + *digits % 100;
}

}  // namespace

std::size_t number_length(ByteView characters, const Word& word) {
  if (!word.variable) return word.characters;
  std::size_t length = 0;
  while (length < characters.size() &&
         (is_digit(characters[length], word.notation) ||
          (length == 0 && word.sign_bits != 0 && (characters[0] == '-' || characters[0] == '+'))))
    ++length;
  return length;
}

std::optional<std::uint64_t> number_of(ByteView characters, const Word& word) {
  if (word.notation == Notation::kChannel) {
    Word decimal = word;
    decimal.notation = Notation::kDecimal;
    return item_of_channel(number_of(characters, decimal));
  }
  if (word.variable) return free_number(characters, word);
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
  if (word.notation == Notation::kChannel) number = 100 * (number / 16) + number % 16;
  if (word.variable) {
    const bool negative = word.sign_bits != 0 && (number >> (word.sign_bits - 1) & 1u) != 0;
    if (negative) number = (~number + 1) & mask(word.sign_bits);
    const std::string text =
        word.notation == Notation::kHex ? fmt::format("{:X}", number) : std::to_string(number);
    Bytes characters(text.begin(), text.end());
    if (negative) characters.insert(characters.begin(), '-');
    return characters;
  }
  Bytes text;
  if (word.notation == Notation::kBcd) {
    text = bcd_characters(number, word);
  } else if (word.notation == Notation::kHex) {
    append_hex(text, number, word.characters);
  } else {
    const std::uint64_t base = word.notation == Notation::kBinary ? 256 : 10;
    for (unsigned i = 0; i < word.characters; ++i, number /= base) {
      text.insert(text.begin(), static_cast<std::uint8_t>(number % base + (base == 10 ? '0' : 0)));
    }
  }
  return highest_first(text, word);  // the conversion is its own inverse
}

}  // namespace fieldcast::sim
