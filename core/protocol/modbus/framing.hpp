// The three framings of a PDU. Each wraps a request and finds its response in the received bytes.
//
//     RTU     unit PDU CRC-low CRC-high
//     ASCII   ':' hex(unit PDU LRC) CR LF
//     TCP     transaction(2) protocol(2)=0 length(2) unit PDU      length counts unit and PDU
//
// Reception uses lengths only, not silence: USB adapters and serial servers merge and split frames.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>

#include "core/protocol/modbus/request.hpp"
#include "core/protocol/protocol.hpp"
#include "core/protocol/protocol_entry.hpp"

namespace fieldcast::modbus {

struct Header {
  std::uint8_t unit = 1;
  std::uint16_t transaction = 0;  // only for TCP
};

struct ParseResult {
  enum class Kind : std::uint8_t {
    kNothing,    // no response yet: at most foreign frames or noise
    kBegun,      // a response has begun or is broken; `missing` characters may complete it
    kResponse,   // `pdu` is the response
    kException,  // `pdu` is an exception of the requested function
    kHopeless,   // the stream has lost its framing
  };
  Kind kind = Kind::kNothing;
  std::uint32_t missing = 0;
  Cause cause = Cause::kNoResponse;  // cause of the failure if no more bytes arrive
  ByteView pdu;                      // refers to the given bytes, or to the scratch buffer
  // kBegun: response behind what looks like another frame, which is noise if it never ends.
  ByteView fallback;
};

inline constexpr std::size_t kMaxRtuFrame = 256;

// The standard has no lower-case digits, but some devices send them.
[[nodiscard]] constexpr int ascii_digit(std::uint8_t c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

// A decoded frame: unit, PDU, LRC.
using Scratch = std::array<std::uint8_t, 256>;

// Four of the largest frames; more means that the line never becomes silent.
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

// As ProtocolEntry::first_frame.
[[nodiscard]] std::optional<std::size_t> first_tcp_frame(ByteView stream);

[[nodiscard]] std::vector<FrameField> explain_rtu(ByteView frame);
[[nodiscard]] std::vector<FrameField> explain_ascii(ByteView frame);
[[nodiscard]] std::vector<FrameField> explain_tcp(ByteView frame);

[[nodiscard]] SeenRequest seen_rtu_request(ByteView bytes);
[[nodiscard]] SeenRequest seen_ascii_request(ByteView bytes);

class ModbusExchange final : public Exchange {
 public:
  // REQUIRES: pdu_sizes(request, options) holds a value.
  ModbusExchange(const Framing& framing, Header header, const Request& request,
                 const Options& options)
      : ModbusExchange(framing, header, RequestPdu(request, options)) {}
  ModbusExchange(const Framing& framing, Header header, RequestPdu request)
      : framing_(framing), header_(header), request_(std::move(request)) {}

  Step start(Bytes& out) override;
  Step on_bytes(ByteView all, Bytes& out) override;
  Step on_silence(Bytes& out) override;
  const Reply& reply() const override { return reply_; }

 private:
  Step take(ByteView pdu);

  const Framing& framing_;
  const Header header_;
  const RequestPdu request_;
  Scratch scratch_;
  Reply reply_;
  Cause silence_ = Cause::kNoResponse;  // cause of a failure if no more bytes arrive
  Bytes fallback_;  // the response, if silence shows that the bytes before it were noise
};

}  // namespace fieldcast::modbus
