#include "core/protocol/declared/word.hpp"

#include <algorithm>

#include "core/codec/digits.hpp"

namespace fieldcast::declared {

// Bit by bit, as frames are short and the wire is slow.
std::uint64_t crc_of(const Crc& rule, ByteView bytes) {
  const std::uint64_t mask = UINT64_MAX >> (64 - rule.width), top = mask - (mask >> 1);
  std::uint64_t crc = rule.start;
  for (const std::uint8_t byte : bytes) {
    for (unsigned i = 0; i < 8; ++i) {
      const bool bit = (byte >> (rule.reflect_in ? i : 7 - i) & 1u) != 0;
      const bool divides = ((crc & top) != 0) != bit;
      crc = crc << 1 & mask;
      if (divides) crc ^= rule.polynomial;
    }
  }
  if (!rule.reflect_out) return crc ^ rule.final_xor;
  std::uint64_t turned = 0;
  for (unsigned i = 0; i < rule.width; ++i) turned |= (crc >> i & 1u) << (rule.width - 1u - i);
  return turned ^ rule.final_xor;
}

Bytes ByteTransform::meant(ByteView bytes) const {
  Bytes plain(bytes.begin(), bytes.end());
  for (std::uint8_t& byte : plain) byte = meant(byte);
  return plain;
}

std::uint64_t check_of(const Check& check, unsigned bits, ByteView bytes) {
  std::uint64_t value = check.kind == CheckKind::kAnd ? 0xFF : check.start;
  switch (check.kind) {
    case CheckKind::kSum:
      for (const std::uint8_t byte : bytes) value += byte;
      break;
    case CheckKind::kAnd:
      for (const std::uint8_t byte : bytes) value &= byte;
      break;
    case CheckKind::kXor:
      for (const std::uint8_t byte : bytes) value ^= byte;
      break;
    case CheckKind::kCrc: value = crc_of(check.crc, bytes); break;
  }
  if (check.complement == Complement::kOnes) value = ~value;
  if (check.complement == Complement::kTwos) value = 0 - value;
  return bits >= 64 ? value : value & ((std::uint64_t{1} << bits) - 1);
}

namespace {

std::uint64_t base_of(Notation notation) {
  switch (notation) {
    case Notation::kBinary: return 256;
    case Notation::kHex: return 16;
    case Notation::kDecimal: return 10;
    case Notation::kBcd: return 100;
  }
  return 256;
}

// The two hexadecimal digits of a byte stay together in either byte order.
std::size_t column(const Word& word, std::size_t power) {
  if (!word.little_endian) return word.characters - 1u - power;
  return word.notation == Notation::kHex ? power ^ 1u : power;
}

}  // namespace

std::uint64_t largest(const Word& word) {
  if (word.notation == Notation::kDecimal || word.notation == Notation::kBcd) {
    std::uint64_t limit = 1;
    for (unsigned i = 0; i < word.characters; ++i) limit *= base_of(word.notation);
    return (word.sign_bits != 0 ? limit / 10 * 8 : limit) - 1;
  }
  const unsigned bits = word.characters * (word.notation == Notation::kHex ? 4u : 8u);
  return bits >= 64 ? UINT64_MAX : (std::uint64_t{1} << bits) - 1;
}

void append_word(Bytes& out, const Word& word, std::uint64_t number) {
  static constexpr char kDigits[] = "0123456789ABCDEF";
  const std::uint64_t base = base_of(word.notation);
  const std::size_t at = out.size();
  const bool negative = word.sign_bits != 0 && (number >> (word.sign_bits - 1) & 1u) != 0;
  if (negative) number = (0 - number) & (UINT64_MAX >> (64 - word.sign_bits));
  out.resize(at + word.characters);
  for (std::size_t power = 0; power < word.characters; ++power, number /= base) {
    const auto digit = static_cast<std::uint8_t>(number % base);
    out[at + column(word, power)] = word.notation == Notation::kBcd
                                        ? static_cast<std::uint8_t>(digit / 10 << 4 | digit % 10)
                                    : base == 256 ? digit
                                                  : static_cast<std::uint8_t>(kDigits[digit]);
  }
  if (negative) out[at + column(word, word.characters - 1u)] |= 0x80u;
}

std::optional<std::uint64_t> read_word(ByteView characters, const Word& word) {
  if (!could_begin(characters, word)) return std::nullopt;
  const std::uint64_t base = base_of(word.notation);
  std::uint64_t number = 0;
  bool negative = false;
  for (std::size_t power = word.characters; power-- > 0;) {
    std::uint8_t c = characters[column(word, power)];
    if (word.sign_bits != 0 && power + 1 == word.characters) negative = c >> 7 != 0, c &= 0x7Fu;
    const std::uint64_t digit = word.notation == Notation::kBcd ? (c >> 4) * 10u + (c & 0xFu)
                                : base == 256                   ? c
                                              : static_cast<std::uint64_t>(hex_digit(c));
    number = number * base + digit;
  }
  return negative ? (0 - number) & (UINT64_MAX >> (64 - word.sign_bits)) : number;
}

bool could_begin(ByteView characters, const Word& word) {
  if (word.notation == Notation::kBinary) return true;
  if (word.notation == Notation::kBcd) {
    for (std::size_t i = 0; i < characters.size(); ++i) {
      const bool highest = i % word.characters == column(word, word.characters - 1u);
      const unsigned c = characters[i] & (word.sign_bits != 0 && highest ? 0x7Fu : 0xFFu);
      if (c >> 4 > 9 || (c & 0xFu) > 9) return false;
    }
    return true;
  }
  const int base = static_cast<int>(base_of(word.notation));
  return std::ranges::all_of(characters,
                             [&](auto c) { return hex_digit(c) >= 0 && hex_digit(c) < base; });
}

}  // namespace fieldcast::declared
