// Symbols of a DF1 line (1770-6.5.16, chapters 2 and 5).
//
//     packet   10 02 data 10 03 check           data: DST SRC CMD STS TNS(2) ..; each 10 is doubled
//     master   10 01 STN 10 02 data 10 03 check  half duplex: station number of the slave
//     poll     10 05 STN BCC                     half duplex
//     ACK      10 06
//     NAK      10 15
//     ENQ      10 05                             full duplex: repeat your last ACK or NAK
//     EOT      10 04                             half duplex: nothing to send
//
// The check is a BCC (two's complement of the sum of STN and data) or a CRC-16 (start 0, low byte
// first) over data and ETX; in a frame of a half-duplex master over STN, STX, data and ETX. It is
// never doubled. A poll always has a BCC.
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/bytes.hpp"

namespace fieldcast::df1 {

inline constexpr std::uint8_t kSoh = 0x01, kStx = 0x02, kEtx = 0x03, kEot = 0x04, kEnq = 0x05,
                              kAck = 0x06, kDle = 0x10, kNak = 0x15;

enum class Check : std::uint8_t { kCrc, kBcc };
[[nodiscard]] constexpr std::size_t size_of(Check check) { return check == Check::kCrc ? 2 : 1; }

inline constexpr std::size_t kHead = 6;         // DST SRC CMD STS TNS
inline constexpr std::size_t kMaxPacket = 256;  // bytes of data
inline constexpr std::size_t kSymbol = 2;       // DLE and its code
inline constexpr std::size_t kEnvelope = 4;     // DLE STX, DLE ETX

// `station`: of a frame of a half-duplex master.
void append_packet(Bytes& out, ByteView packet, Check check,
                   std::optional<std::uint8_t> station = std::nullopt);
void append_poll(Bytes& out, std::uint8_t station);
inline void append_symbol(Bytes& out, std::uint8_t symbol) {
  out.push_back(kDle);
  out.push_back(symbol);
}

struct Symbol {
  enum class Kind : std::uint8_t { kNoise, kOpen, kBroken, kControl, kPacket };
  Kind kind = Kind::kNoise;
  std::size_t size = 1;      // characters; of an open or broken packet as far as it goes
  std::size_t missing = 0;   // kOpen: at least
  std::uint8_t control = 0;  // kControl: kAck, kNak, kEnq or kEot
  Bytes packet{};            // data between STX and ETX
};
// The symbol at the beginning of the bytes, as a slave sends it. An ACK or NAK within a packet is
// an embedded response and is skipped. Without `check` a packet ends with ETX. REQUIRES: bytes is
// not empty.
[[nodiscard]] Symbol parse_symbol(ByteView bytes, std::optional<Check> check);
[[nodiscard]] Bytes check_of(ByteView packet, Check check, std::optional<std::uint8_t> station);

}  // namespace fieldcast::df1
