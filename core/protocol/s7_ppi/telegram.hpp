// Telegrams of the PPI line.
//
//     SD2 data    68 LE LE 68 DA SA FC message.. FCS 16  LE counts DA to the last byte of it
//     SD1 short   10 DA SA FC FCS 16
//     SC          E5
//     SD4 token   DC DA SA                               of other masters: skipped
//
// FCS: sum of DA to the last byte before it. There is no escaping, so the length determines the end
// of a telegram.
#pragma once

#include <cstdint>

#include "core/base/bytes.hpp"

namespace fieldcast::s7_ppi {

inline constexpr std::uint8_t kMarkAcknowledge = 0xE5;
inline constexpr std::uint8_t kMarkLong = 0x68, kMarkShort = 0x10, kMarkToken = 0xDC, kEnd = 0x16;
inline constexpr std::size_t kLongFrame = 6;  // bytes of SD2 that are not counted
inline constexpr std::size_t kLinkHead = 3;   // DA SA FC
inline constexpr std::size_t kShortSize = 6;
inline constexpr std::uint8_t kHighestAddress = 126;
inline constexpr std::size_t kMaxLong = 255;

void append_long(Bytes& out, std::uint8_t to, std::uint8_t from, std::uint8_t control,
                 ByteView message);
void append_short(Bytes& out, std::uint8_t to, std::uint8_t from, std::uint8_t control);

struct Telegram {
  enum class Kind : std::uint8_t { kNoise, kOpen, kBroken, kAcknowledge, kToken, kShort, kLong };
  Kind kind = Kind::kNoise;
  std::size_t size = 1;  // bytes to skip; kOpen: of the whole telegram, as far as known
  std::uint8_t to = 0, from = 0, control = 0;
  ByteView message;  // for kLong
};
// REQUIRES: bytes is not empty.
[[nodiscard]] Telegram parse_telegram(ByteView bytes);

}  // namespace fieldcast::s7_ppi
