#pragma once

#include <cstdint>
#include <optional>

#include "core/base/bytes.hpp"

namespace fieldcast::declared {

// Rocksoft model of a 16-bit CRC; reflected: lowest bit first, in input and result.
struct Crc16 {
  std::uint16_t polynomial = 0x8005, start = 0xFFFF, final_xor = 0x0000;
  bool reflected = true;
  friend bool operator==(const Crc16&, const Crc16&) = default;
};
[[nodiscard]] std::uint16_t crc16(const Crc16& crc, ByteView bytes);

enum class CheckKind : std::uint8_t { kSum, kAnd, kXor, kCrc16 };
enum class Complement : std::uint8_t { kNone, kOnes, kTwos };

struct Check {
  CheckKind kind = CheckKind::kSum;
  Complement complement = Complement::kNone;
  Crc16 crc;
  // For hexadecimal fields: covers the decoded bytes instead of the digits.
  bool over_bytes = false;
  friend bool operator==(const Check&, const Check&) = default;
};

// A sum is taken modulo 2^bits (8..32); other kinds have a fixed width.
[[nodiscard]] std::uint64_t check_of(const Check& check, unsigned bits, ByteView bytes);

// A number on the wire: binary bytes, or a fixed number of ASCII digits. Pure functions.
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
