// The three ways a PDU travels. Each wraps a request, and finds the answer to it in the bytes that
// came back.
//
//     RTU     unit PDU CRC-low CRC-high
//     ASCII   ':' hex(unit PDU LRC) CR LF
//     TCP     transaction(2) protocol(2)=0 length(2) unit PDU      length counts unit and PDU
//
// Reception is driven by lengths alone, never by silence: USB adapters and serial servers merge and
// split frames as they like.
#pragma once

#include <array>
#include <cstdint>

#include "core/protocol/modbus/request.hpp"
#include "core/protocol/protocol.hpp"
#include "core/protocol/seen_request.hpp"

namespace fieldcast::modbus {

// What a framing adds to a PDU: whom it goes to, and which request it is.
struct Header {
  std::uint8_t unit = 1;
  std::uint16_t transaction = 0;  // TCP alone
};

// What the bytes received so far are.
struct ParseResult {
  enum class Kind : std::uint8_t {
    kNothing,    // no answer yet: foreign frames or noise at most
    kBegun,      // an answer has begun or came broken; `missing` more characters may complete it
    kAnswer,     // `pdu` is the answer
    kException,  // `pdu` is an exception of our function
    kHopeless,   // the stream itself is out of step
  };
  Kind kind = Kind::kNothing;
  std::uint32_t missing = 0;
  Cause cause = Cause::kNoAnswer;  // why the exchange fails if nothing more comes
  ByteView pdu;                    // into the bytes given, or into the scratch
  // kBegun: the answer or exception stands behind what looks like the beginning of another frame.
  // If that frame never ends it was noise, and this is the answer.
  ByteView fallback;
};

// Bytes of the largest RTU frame.
inline constexpr std::size_t kMaxRtuFrame = 256;

// The value of 0-9, A-F or a-f; -1 for any other character. Lower case is no digit of the standard,
// but devices that send it mean what they say.
[[nodiscard]] constexpr int ascii_digit(std::uint8_t c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

// Room for a decoded frame: unit, PDU, LRC.
using Scratch = std::array<std::uint8_t, 256>;

// More than this since the request is a babbling line, not an answer: four of the largest frames.
inline constexpr std::size_t kMaxReceived = 2100;

struct Framing {
  std::size_t (*size)(std::size_t pdu_size);  // characters of a frame
  void (*wrap)(const Header& header, ByteView pdu, Bytes& out);
  ParseResult (*find)(ByteView all, const Header& header, const RequestPdu& request,
                      Scratch& scratch);
};

[[nodiscard]] const Framing& rtu_framing();
[[nodiscard]] const Framing& ascii_framing();
[[nodiscard]] const Framing& tcp_framing();

[[nodiscard]] std::vector<FrameField> explain_rtu(ByteView frame);
[[nodiscard]] std::vector<FrameField> explain_ascii(ByteView frame);
[[nodiscard]] std::vector<FrameField> explain_tcp(ByteView frame);

[[nodiscard]] SeenRequest seen_rtu_request(ByteView bytes);
[[nodiscard]] SeenRequest seen_ascii_request(ByteView bytes);

}  // namespace fieldcast::modbus
