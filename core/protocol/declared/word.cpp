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
    case Notation::kDecimal:
    case Notation::kChannel: return 10;
    case Notation::kBcd: return 100;
  }
  return 256;
}

// The two hexadecimal digits of a byte stay together in either byte order.
std::size_t column(const Word& word, std::size_t power) {
  if (!word.little_endian) return word.characters - 1u - power;
  return word.notation == Notation::kHex ? power ^ 1u : power;
}

// Removes the sign of BCD from the byte with the highest digits; returns true for '-'.
bool remove_sign(std::uint8_t& highest, const Word& word) {
  const std::uint8_t sign = word.sign_digit ? 0xF0 : 0x80;
  const bool negative = word.sign_bits != 0 && (highest & sign) == sign;
  if (negative) highest = static_cast<std::uint8_t>(highest & ~sign);
  return negative;
}

bool has_sign(ByteView characters, const Word& word) {
  return word.sign_bits != 0 && !characters.empty() &&
         (characters[0] == '-' || characters[0] == '+');
}

std::optional<std::uint64_t> read_variable(ByteView characters, const Word& word) {
  const bool negative = has_sign(characters, word) && characters[0] == '-';
  if (has_sign(characters, word)) characters = characters.subspan(1);
  if (characters.empty() || characters.size() > word.characters) return std::nullopt;
  const Word digits{word.notation, static_cast<std::uint8_t>(characters.size())};
  const auto number = read_word(characters, digits);
  if (!number || word.sign_bits == 0) return number;
  const std::uint64_t lowest = std::uint64_t{1} << (word.sign_bits - 1);
  if (*number > (negative ? lowest : lowest - 1)) return std::nullopt;
  return negative ? (0 - *number) & (UINT64_MAX >> (64 - word.sign_bits)) : *number;
}

}  // namespace

std::uint64_t largest(const Word& word) {
  if (word.notation != Notation::kBinary && word.notation != Notation::kHex) {
    std::uint64_t limit = 1;
    for (unsigned i = 0; i < word.characters; ++i) limit *= base_of(word.notation);
    if (word.notation == Notation::kChannel) return limit < 100 ? limit - 1 : limit / 100 * 16 - 1;
    const bool sign_in_digit = word.notation == Notation::kBcd && word.sign_bits != 0;
    return (sign_in_digit ? limit / 10 * (word.sign_digit ? 1 : 8) : limit) - 1;
  }
  const unsigned bits = word.characters * (word.notation == Notation::kHex ? 4u : 8u);
  return bits >= 64 ? UINT64_MAX : (std::uint64_t{1} << bits) - 1;
}

std::size_t most_characters(const Word& word) {
  return word.characters + (word.variable && word.sign_bits != 0 ? 1u : 0u);
}

std::size_t width_of(ByteView characters, const Word& word) {
  if (!word.variable) return word.characters;
  const std::size_t sign = has_sign(characters, word) ? 1 : 0;
  const auto end = std::ranges::find_if_not(characters.subspan(sign), [&](std::uint8_t c) {
    return could_begin(ByteView(&c, 1), {.notation = word.notation});
  });
  return static_cast<std::size_t>(end - characters.begin());
}

void append_word(Bytes& out, const Word& word, std::uint64_t number) {
  static constexpr char kDigits[] = "0123456789ABCDEF";
  const std::uint64_t base = base_of(word.notation);
  const std::size_t at = out.size();
  const bool negative = word.sign_bits != 0 && (number >> (word.sign_bits - 1) & 1u) != 0;
  if (negative) number = (0 - number) & (UINT64_MAX >> (64 - word.sign_bits));
  if (word.notation == Notation::kChannel) number = number / 16 * 100 + number % 16;
  out.resize(at + word.characters);
  for (std::size_t power = 0; power < word.characters; ++power, number /= base) {
    const auto digit = static_cast<std::uint8_t>(number % base);
    out[at + column(word, power)] = word.notation == Notation::kBcd
                                        ? static_cast<std::uint8_t>(digit / 10 << 4 | digit % 10)
                                    : base == 256 ? digit
                                                  : static_cast<std::uint8_t>(kDigits[digit]);
  }
  if (word.variable) {
    const auto digits = out.begin() + static_cast<std::ptrdiff_t>(at);
    out.erase(digits, std::find_if(digits, out.end() - 1, [](auto c) { return c != '0'; }));
    if (negative) out.insert(out.begin() + static_cast<std::ptrdiff_t>(at), '-');
  } else if (negative) {
    out[at + column(word, word.characters - 1u)] |= word.sign_digit ? 0xF0u : 0x80u;
  }
}

std::optional<std::uint64_t> read_word(ByteView characters, const Word& word) {
  if (word.variable) return read_variable(characters, word);
  if (!could_begin(characters, word)) return std::nullopt;
  const std::uint64_t base = base_of(word.notation);
  std::uint64_t number = 0;
  bool negative = false;
  for (std::size_t power = word.characters; power-- > 0;) {
    std::uint8_t c = characters[column(word, power)];
    if (power + 1 == word.characters) negative = remove_sign(c, word);
    const std::uint64_t digit = word.notation == Notation::kBcd ? (c >> 4) * 10u + (c & 0xFu)
                                : base == 256                   ? c
                                              : static_cast<std::uint64_t>(hex_digit(c));
    number = number * base + digit;
  }
  if (word.notation == Notation::kChannel) {
    if (number % 100 > 15) return std::nullopt;
    number = number / 100 * 16 + number % 100;
  }
  return negative ? (0 - number) & (UINT64_MAX >> (64 - word.sign_bits)) : number;
}

bool could_begin(ByteView characters, const Word& word) {
  if (word.notation == Notation::kBinary) return true;
  if (word.notation == Notation::kBcd) {
    for (std::size_t i = 0; i < characters.size(); ++i) {
      std::uint8_t c = characters[i];
      if (i % word.characters == column(word, word.characters - 1u)) (void)remove_sign(c, word);
      if (c >> 4 > 9 || (c & 0xFu) > 9) return false;
    }
    return true;
  }
  const int base = static_cast<int>(base_of(word.notation));
  return std::ranges::all_of(characters,
                             [&](auto c) { return hex_digit(c) >= 0 && hex_digit(c) < base; });
}

}  // namespace fieldcast::declared
