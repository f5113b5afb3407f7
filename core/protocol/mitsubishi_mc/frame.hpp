// Messages of the MC protocol (SH-080008, 5.2). A number has its low byte first in binary code, and
// two hexadecimal digits for each byte, the high one first, in ASCII code.
//
//     3E request    50 00 route(5) length(2) timer(2) command(2) subcommand(2) ..
//     3E response   D0 00 route(5) length(2) end(2) data..
//     4E            54 00 or D4 00, serial(2), 00 00, then as 3E from the route on
//     route         network(1) station(1) module(2) unit(1)
//     error part    network(1) station(1) module(2) unit(1) command(2) subcommand(2)
//
// The length counts what follows it: bytes, or digits in ASCII code. The error part is the data of
// a response whose end code is not 0.
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/bytes.hpp"

namespace fieldcast::mitsubishi_mc {

struct Format {
  bool numbered = false;  // 4E: with a serial number
  bool ascii = false;
  bool wide = false;  // iQ-R: longer device numbers and codes
  [[nodiscard]] constexpr std::size_t width() const {
    return ascii ? 2 : 1;
  }  // characters for one byte
  friend bool operator==(const Format&, const Format&) = default;
};

struct Route {
  std::uint8_t network = 0;
  std::uint8_t station = 0xFF;
  std::uint16_t module = 0x03FF;
  std::uint8_t unit = 0;
  friend bool operator==(const Route&, const Route&) = default;
};

inline constexpr std::uint8_t kRequest3e = 0x50, kRequest4e = 0x54, kResponse = 0x80;
inline constexpr std::size_t kSubheader = 2, kSerial = 4, kRoute = 5, kLength = 2;  // bytes
inline constexpr std::size_t kTimer = 2, kEndCode = 2, kCommand = 4, kErrorPart = 9;
// Largest data: 960 words, or in binary code 7168 bits, two in a byte (SH-080008, appendix 5).
inline constexpr std::size_t kMaxDataBinary = 7168 / 2, kMaxDataAscii = 960 * 4;

// Characters up to the length, inclusive.
[[nodiscard]] constexpr std::size_t header_size(const Format& format) {
  return (kSubheader + (format.numbered ? kSerial : 0) + kRoute + kLength) * format.width();
}

void append_number(Bytes& out, const Format& format, std::uint32_t value, std::size_t bytes);

// Reads from the beginning of `text`. Empty for a character that is not a digit.
// REQUIRES: text.size() >= bytes * format.width(), bytes <= 4.
[[nodiscard]] std::optional<std::uint32_t> read_number(ByteView text, const Format& format,
                                                       std::size_t bytes);

// Appends a request; `content`: from the command on.
void append_request(Bytes& out, const Format& format, std::uint16_t serial, const Route& route,
                    std::uint16_t timer, ByteView content);

struct Response {
  enum class Kind : std::uint8_t { kPart, kHopeless, kWhole };
  Kind kind = Kind::kPart;
  std::size_t size = 0;  // characters
  std::uint16_t serial = 0;
  Route route;
  std::uint16_t end_code = 0;
  ByteView data;
};
// The first response of the received characters.
[[nodiscard]] Response first_response(ByteView all, const Format& format);

}  // namespace fieldcast::mitsubishi_mc
