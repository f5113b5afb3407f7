#pragma once

#include <cstddef>

#include "core/base/bytes.hpp"
#include "core/base/time.hpp"
#include "core/frame/line.hpp"

namespace fieldcast::dtc {

// Longer than any message: disables compression.
inline constexpr std::size_t kNever = 65535;

// Compressing and expanding n bytes costs n * per_byte of both ends, while the wire is idle. It
// saves half a character for each byte after the first sixteen, which fill the dictionary, minus
// the two length bytes. The threshold is the smallest n with no loss; kNever if the line is too
// fast.
[[nodiscard]] std::size_t auto_threshold(const LineFormat& line, Duration per_byte);

// The envelope of each DTC message, in both directions.
//
//     packet    flag(1) length(2) body(length)
//     flag 0    body: the message
//     flag 1    body: length of the message(2), then the codes of its LZW
//
// A packet has flag 1 only if that is shorter.
inline constexpr std::uint8_t kPlain = 0, kCompressed = 1;
inline constexpr std::size_t kPacketHead = 3;     // flag and length
inline constexpr std::size_t kOriginalBytes = 2;  // length of the message before the codes
inline constexpr std::size_t kMinMessage = 4;     // address, command, CRC
inline constexpr std::size_t kMaxMessage = 4096;

// Compresses a message of at least `threshold` bytes if the body becomes shorter. Never longer than
// kPacketHead + message.size().
void append_packet(Bytes& out, ByteView message, std::size_t threshold);

struct ParseResult {
  enum class Kind : std::uint8_t { kNoise, kOpen, kWhole };
  Kind kind = Kind::kNoise;
  // kWhole: of the packet. kOpen: of the packet, as far as known. kNoise: bytes to skip.
  std::size_t size = 1;
  bool compressed = false;   // the following fields are only set for kWhole
  std::size_t original = 0;  // bytes of the message
  ByteView content;          // the message, or the codes of its LZW
};
// kNoise: an unknown flag, or an impossible length. REQUIRES: `bytes` is not empty.
[[nodiscard]] ParseResult parse_packet(ByteView bytes);

}  // namespace fieldcast::dtc
