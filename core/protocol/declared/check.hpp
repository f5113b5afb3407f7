// The checksums that a declaration can name. Pure functions.
#pragma once

#include <cstdint>

#include "core/base/bytes.hpp"

namespace fieldcast::declared {

// The parameters of a CRC of 16 bits, in the words of the Rocksoft model: reflected means that the
// lowest bit goes first, in the input as in the result.
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
  bool over_bytes = false;  // of hexadecimal fields: the bytes that the digits mean, not the digits
  friend bool operator==(const Check&, const Check&) = default;
};

// The check of these bytes, as a number of `bits` (8..32): a sum is taken modulo 2^bits, the others
// are as wide as they are.
[[nodiscard]] std::uint64_t check_of(const Check& check, unsigned bits, ByteView bytes);

}  // namespace fieldcast::declared
