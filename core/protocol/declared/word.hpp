#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "core/base/bytes.hpp"

namespace fieldcast::declared {

// Rocksoft model of a CRC of 8 to 64 bits.
struct Crc {
  std::uint8_t width = 16;
  std::uint64_t polynomial = 0x8005, start = 0xFFFF, final_xor = 0x0000;
  bool reflect_in = true, reflect_out = true;
  friend bool operator==(const Crc&, const Crc&) = default;
};
[[nodiscard]] std::uint64_t crc_of(const Crc& crc, ByteView bytes);

struct NamedCrc {
  std::string_view name;  // "crc-16/modbus"
  Crc crc;
};
// The catalogue of parametrised CRC algorithms (reveng.sourceforge.io), widths 8 to 64.
[[nodiscard]] std::span<const NamedCrc> crc_catalogue();

enum class CheckKind : std::uint8_t { kSum, kAnd, kXor, kCrc };
enum class Complement : std::uint8_t { kNone, kOnes, kTwos };

struct Check {
  CheckKind kind = CheckKind::kSum;
  Complement complement = Complement::kNone;
  Crc crc;
  // Covers what the characters represent: decoded hexadecimal digits, bytes before their transform.
  bool over_bytes = false;
  std::uint32_t start = 0;  // of a sum and a xor
  friend bool operator==(const Check&, const Check&) = default;
};

// A sum is taken modulo 2^bits (8..32); other kinds have a fixed width.
[[nodiscard]] std::uint64_t check_of(const Check& check, unsigned bits, ByteView bytes);

// Changes each byte of a field: (byte + add) ^ exor is sent.
struct ByteTransform {
  std::uint8_t add = 0, exor = 0;
  [[nodiscard]] explicit operator bool() const { return add != 0 || exor != 0; }
  [[nodiscard]] std::uint8_t sent(std::uint8_t byte) const {
    return static_cast<std::uint8_t>((byte + add) ^ exor);
  }
  [[nodiscard]] std::uint8_t meant(std::uint8_t byte) const {
    return static_cast<std::uint8_t>((byte ^ exor) - add);
  }
  [[nodiscard]] Bytes meant(ByteView bytes) const;
  friend bool operator==(const ByteTransform&, const ByteTransform&) = default;
};

// A number on the wire: binary bytes, packed decimal digits, or ASCII digits. Pure functions.
enum class Notation : std::uint8_t {
  kBinary,
  kHex,  // upper-case digits, two per byte
  kDecimal,
  kBcd,  // two decimal digits in each byte, the higher in the upper half
  // Decimal digits; the last two are the place in a channel of 16, those before it the channel.
  kChannel,
};

struct Word {
  Notation notation = Notation::kBinary;
  std::uint8_t characters = 1;  // 1..8 bytes, 1..9 of BCD, 1..16 hex digits, 1..18 decimal digits
  bool little_endian = false;   // lowest byte first, also for pairs of hex digits
  // The number is a two's complement of so many bits: BCD has its sign in the highest bit, digits
  // of variable width have '-' before them. 0: no sign.
  std::uint8_t sign_bits = 0;
  // ASCII digits without leading zeros, at most `characters` of them. A received number may have
  // leading zeros and, with a sign, '+'.
  bool variable = false;
  // The sign of BCD is F in the highest digit, as in M-Bus records (EN 13757-3, type A).
  bool sign_digit = false;
  friend bool operator==(const Word&, const Word&) = default;
};

[[nodiscard]] std::uint64_t largest(const Word& word);

// Characters of the longest number, with its sign.
[[nodiscard]] std::size_t most_characters(const Word& word);

// Characters of the number at the start of `characters`: the fixed width, or the sign and all
// digits that follow.
[[nodiscard]] std::size_t width_of(ByteView characters, const Word& word);

void append_word(Bytes& out, const Word& word, std::uint64_t number);

// Empty if a character is not a digit, or if a number of variable width has too many digits or
// bits. REQUIRES: characters.size() == word.characters, or word.variable.
[[nodiscard]] std::optional<std::uint64_t> read_word(ByteView characters, const Word& word);

[[nodiscard]] bool could_begin(ByteView characters, const Word& word);

}  // namespace fieldcast::declared
