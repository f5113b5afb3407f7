// Frames of the MC protocol on serial lines (SH-080008, 4.2 and 4.3). In the formats 1 to 4 all
// characters are ASCII. Format 2 has a block number of two digits before the header, and format 4
// adds CR LF to each frame.
//
//                   formats 1, 2 and 4              format 3
//     request       05 header command.. sum(2)      02 header command.. 03 sum(2)
//     response      02 header data.. 03 sum(2)      02 header "QACK" data.. 03 sum(2)
//     no data       06 header                       02 header "QACK" 03
//     refusal       15 header code(4; 1C: 2)        02 header "QNAK" code(4; 1C: 2) 03
//     header  4C    "F8" station(2) network(2) PC(2) module(4) unit(2) own station(2)
//             3C    "F9" station(2) network(2) PC(2) own station(2)
//             1C    station(2) PC(2), with "GG" and "NN" for "QACK" and "QNAK"
//
// The sum covers the characters after 05 or 02, with 03. Format 5 carries 4C frames in binary code:
//
//     request       10 02 count(2) header command.. 10 03 sum(2)
//     response      10 02 count(2) header FF FF code(2) data.. 10 03 sum(2)
//
// Its count and its sum do not include the marks, and neither does the second 10 that is sent for
// each 10 in between. The sum is two ASCII digits in all formats.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "core/base/bytes.hpp"

namespace fieldcast::mitsubishi_mc {

inline constexpr std::uint8_t kStx = 0x02, kEtx = 0x03, kEnq = 0x05, kAck = 0x06, kDle = 0x10,
                              kNak = 0x15;

inline constexpr std::size_t kCount = 2;  // bytes of the count of format 5

enum class SerialFrame : std::uint8_t { k4c, k3c, k1c };

struct SerialFormat {
  SerialFrame frame = SerialFrame::k4c;
  bool numbered = false;  // format 2: with a block number
  bool enclosed = false;  // format 3: between 02 and 03, with end codes
  bool line_end = false;  // format 4
  bool binary = false;    // format 5
  bool sum_check = true;

  [[nodiscard]] constexpr std::size_t sum_size() const { return sum_check ? 2 : 0; }
  [[nodiscard]] constexpr std::size_t end_size() const { return line_end ? 2 : 0; }
  // Characters of the code of a refusal.
  [[nodiscard]] constexpr std::size_t code_size() const {
    return binary || frame == SerialFrame::k1c ? 2 : 4;
  }
  [[nodiscard]] constexpr std::size_t end_code_size() const { return enclosed ? code_size() : 0; }
};

// End codes of format 3.
struct EndCodePair {
  std::string_view done, refused;
};
[[nodiscard]] constexpr EndCodePair end_codes_of(SerialFrame frame) {
  return frame == SerialFrame::k1c ? EndCodePair{"GG", "NN"} : EndCodePair{"QACK", "QNAK"};
}

struct SerialRoute {
  std::uint8_t station = 0, network = 0, pc = 0xFF;
  std::uint16_t module = 0x03FF;
  std::uint8_t unit = 0, own_station = 0;
};

// Sizes of headers by SerialFrame; half of it in binary code.
inline constexpr std::size_t kHeaderDigits[] = {16, 10, 4};
inline constexpr std::size_t kBlockDigits = 2;
// With the block number of format 2.
[[nodiscard]] constexpr std::size_t header_size(const SerialFormat& format) {
  return kHeaderDigits[static_cast<std::size_t>(format.frame)] / (format.binary ? 2 : 1) +
         (format.numbered ? kBlockDigits : 0);
}
// `block`: used in format 2.
[[nodiscard]] Bytes header_of(const SerialFormat& format, const SerialRoute& route,
                              std::uint8_t block);

// `content`: from the command on.
void append_request(Bytes& out, const SerialFormat& format, ByteView header, ByteView content);
// Characters without the second 10 of format 5, which depends on the data.
[[nodiscard]] std::size_t request_size(const SerialFormat& format, std::size_t content);
[[nodiscard]] std::size_t response_size(const SerialFormat& format, std::size_t data);

// The characters between the marks of format 5 without the second 10 of each pair.
struct Unstuffed {
  enum class Kind : std::uint8_t { kOpen, kBroken, kWhole };
  Kind kind = Kind::kOpen;
  Bytes text;            // from the count on
  std::size_t size = 0;  // characters of the frame up to 10 03, inclusive
};
// REQUIRES: `bytes` begins with 10 02.
[[nodiscard]] Unstuffed unstuffed(ByteView bytes);

struct SerialResponse {
  enum class Kind : std::uint8_t { kNothing, kOpen, kBroken, kData, kDone, kRefused };
  Kind kind = Kind::kNothing;
  std::size_t end = 0;     // offset behind the frame; of kOpen: of its beginning
  Bytes header, data;      // kData, kDone, kRefused
  std::uint16_t code = 0;  // kRefused
};
// The first response of untrusted characters.
[[nodiscard]] SerialResponse first_response(ByteView all, const SerialFormat& format);

}  // namespace fieldcast::mitsubishi_mc
