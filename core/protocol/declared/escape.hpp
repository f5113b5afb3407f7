// Escapes bytes of a frame that look like its marks. Pure functions.
#pragma once

#include <cstdint>

#include "core/base/bytes.hpp"

namespace fieldcast::declared {

enum class Escape : std::uint8_t {
  kNone,
  kDle,   // 10 is sent twice; 10 before any other byte is a mark
  kSlip,  // RFC 1055: C0 is a mark, sent as DB DC; DB is sent as DB DD
  kCobs,  // consistent overhead byte stuffing: 00 is a mark
  // A byte is sent behind an escape byte, with some of its bits inverted.
  kHdlc,   // RFC 1662, 4.2: 7E and 7D behind 7D, with bit 5
  kShdlc,  // Sensirion SHDLC: also 11 and 13
  kKmp,    // Kamstrup Meter Protocol: 80, 40, 0D, 06 and 1B behind 1B, with all bits; 0D is a mark
};

[[nodiscard]] Bytes escaped(Escape escape, ByteView plain);

struct Unescaped {
  Bytes plain;
  std::size_t used = 0;  // characters, without the mark
  bool ended = false;    // a mark follows
  bool invalid = false;
};
[[nodiscard]] Unescaped unescape(Escape escape, ByteView wire);

}  // namespace fieldcast::declared
