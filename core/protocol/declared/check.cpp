#include "core/protocol/declared/check.hpp"

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

}  // namespace fieldcast::declared
