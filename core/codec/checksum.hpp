// Pure functions, header only: the simulator's devices use only this file of the codecs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/bytes.hpp"

namespace fieldcast {

namespace detail {

// Two tables allow two independent look-ups for two bytes: [0] one byte, [1] one byte and a zero.
struct Crc16Tables {
  std::array<std::array<std::uint16_t, 256>, 2> of{};
  constexpr Crc16Tables() {
    for (unsigned byte = 0; byte < 256; ++byte) {
      unsigned crc = byte;
      for (int bit = 0; bit < 8; ++bit) crc = (crc & 1u) != 0 ? crc >> 1 ^ 0xA001u : crc >> 1;
      of[0][byte] = static_cast<std::uint16_t>(crc);
    }
    for (unsigned byte = 0; byte < 256; ++byte) {
      const unsigned crc = of[0][byte];
      of[1][byte] = static_cast<std::uint16_t>(crc >> 8 ^ of[0][crc & 0xFFu]);
    }
  }
};
inline constexpr Crc16Tables kCrc16Tables{};

}  // namespace detail

// CRC-16/ARC: polynomial 8005h reflected, start 0; sent low byte first (DF1, 1770-6.5.16, 5-6).
[[nodiscard]] constexpr std::uint16_t crc16_arc(ByteView bytes, unsigned start = 0) {
  const auto& tables = detail::kCrc16Tables.of;
  unsigned crc = start;
  std::size_t i = 0;
  for (; i + 1 < bytes.size(); i += 2) {
    crc ^= static_cast<unsigned>(bytes[i] | bytes[i + 1] << 8);
    crc = static_cast<unsigned>(tables[1][crc & 0xFF] ^ tables[0][crc >> 8]);
  }
  if (i < bytes.size()) crc = crc >> 8 ^ tables[0][(crc ^ bytes[i]) & 0xFF];
  return static_cast<std::uint16_t>(crc);
}

// CRC-16/MODBUS: the same with start FFFFh. "123456789" gives 4B37h (Modbus over Serial Line V1.02,
// 6.2.2).
[[nodiscard]] constexpr std::uint16_t crc16_modbus(ByteView bytes) {
  return crc16_arc(bytes, 0xFFFF);
}

// Appends the CRC of the bytes from `start` on, low byte first.
inline void append_crc16(Bytes& out, std::size_t start = 0) {
  const std::uint16_t crc = crc16_modbus(ByteView(out).subspan(start));
  out.push_back(static_cast<std::uint8_t>(crc));
  out.push_back(static_cast<std::uint8_t>(crc >> 8));
}

// Returns true if the last two bytes are the CRC of the others. REQUIRES: at least two bytes.
[[nodiscard]] constexpr bool ends_with_crc16(ByteView frame) {
  const std::size_t end = frame.size() - 2;
  return crc16_modbus(frame.first(end)) == (frame[end] | frame[end + 1] << 8);
}

// Sum of all bytes modulo 256 (PPI, FX).
[[nodiscard]] constexpr std::uint8_t sum8(ByteView bytes) {
  unsigned sum = 0;
  for (const std::uint8_t byte : bytes) sum += byte;
  return static_cast<std::uint8_t>(sum);
}

// Two's complement of the sum: all bytes and the LRC add up to 0 (Modbus over Serial Line V1.02,
// 6.2.1).
[[nodiscard]] constexpr std::uint8_t lrc8(ByteView bytes) {
  return static_cast<std::uint8_t>(0x100u - sum8(bytes));
}

// Exclusive or of all bytes (Host Link, S7 freeport).
[[nodiscard]] constexpr std::uint8_t xor8(ByteView bytes) {
  unsigned sum = 0;
  for (const std::uint8_t byte : bytes) sum ^= byte;
  return static_cast<std::uint8_t>(sum);
}

}  // namespace fieldcast
