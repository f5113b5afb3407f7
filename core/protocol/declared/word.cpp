#include "core/protocol/declared/word.hpp"

#include <algorithm>

#include "core/codec/digits.hpp"

namespace fieldcast::declared {

namespace {

std::uint16_t reflect(std::uint16_t value) {
  unsigned turned = 0;
  for (unsigned i = 0; i < 16; ++i) turned |= (value >> i & 1u) << (15 - i);
  return static_cast<std::uint16_t>(turned);
}

}  // namespace

// Bit by bit, as frames are short and the wire is slow.
std::uint16_t crc16(const Crc16& rule, ByteView bytes) {
  const unsigned polynomial = rule.reflected ? reflect(rule.polynomial) : rule.polynomial;
  unsigned crc = rule.reflected ? reflect(rule.start) : rule.start;
  for (const std::uint8_t byte : bytes) {
    crc ^= rule.reflected ? byte : byte << 8;
    for (int bit = 0; bit < 8; ++bit) {
      if (rule.reflected)
        crc = (crc & 1u) != 0 ? crc >> 1 ^ polynomial : crc >> 1;
      else
        crc = ((crc & 0x8000u) != 0 ? crc << 1 ^ polynomial : crc << 1) & 0xFFFFu;
    }
  }
  return static_cast<std::uint16_t>(crc ^ rule.final_xor);
}

std::uint64_t check_of(const Check& check, unsigned bits, ByteView bytes) {
  std::uint64_t value = check.kind == CheckKind::kAnd ? 0xFF : 0;
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
    case CheckKind::kCrc16: value = crc16(check.crc, bytes); break;
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
  if (word.notation == Notation::kDecimal) {
    std::uint64_t limit = 1;
    for (unsigned i = 0; i < word.characters; ++i) limit *= 10;
    return limit - 1;
  }
  const unsigned bits = word.characters * (word.notation == Notation::kHex ? 4u : 8u);
  return bits >= 64 ? UINT64_MAX : (std::uint64_t{1} << bits) - 1;
}

void append_word(Bytes& out, const Word& word, std::uint64_t number) {
  static constexpr char kDigits[] = "0123456789ABCDEF";
  const std::uint64_t base = base_of(word.notation);
  const std::size_t at = out.size();
  out.resize(at + word.characters);
  for (std::size_t power = 0; power < word.characters; ++power, number /= base) {
    const auto digit = static_cast<std::uint8_t>(number % base);
    out[at + column(word, power)] = base == 256 ? digit : static_cast<std::uint8_t>(kDigits[digit]);
  }
}

std::optional<std::uint64_t> read_word(ByteView characters, const Word& word) {
  if (!could_begin(characters, word)) return std::nullopt;
  const std::uint64_t base = base_of(word.notation);
  std::uint64_t number = 0;
  for (std::size_t power = word.characters; power-- > 0;) {
    const std::uint8_t c = characters[column(word, power)];
    number = number * base + (base == 256 ? c : static_cast<std::uint64_t>(hex_digit(c)));
  }
  return number;
}

bool could_begin(ByteView characters, const Word& word) {
  const int base = static_cast<int>(base_of(word.notation));
  return base == 256 || std::ranges::all_of(characters, [&](auto c) {
           return hex_digit(c) >= 0 && hex_digit(c) < base;
         });
}

}  // namespace fieldcast::declared
