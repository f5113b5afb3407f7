#include "tools/sim/families/modbus/modbus_receivers.hpp"

#include "core/codec/checksum.hpp"
#include "tools/sim/device/device.hpp"

namespace fieldcast::sim {
namespace {

constexpr std::size_t kMaxRtuFrame = 256;
constexpr std::size_t kMaxAsciiDigits = 510;  // 513 without ':' CR LF
constexpr std::size_t kTcpHeader = 7;

// Length of an RTU frame, as far as its first bytes determine it.
struct Length {
  enum class Known : std::uint8_t { kYes, kNotYet, kNever } known;
  std::size_t bytes = 0;
};
constexpr Length kNotYet{Length::Known::kNotYet};
constexpr Length kUnknowable{Length::Known::kNever};
constexpr Length exactly(std::size_t bytes) { return {Length::Known::kYes, bytes}; }

Length counted(ByteView frame, std::size_t at, std::size_t fixed) {
  return frame.size() > at ? exactly(fixed + frame[at]) : kNotYet;
}

Length request_length(ByteView frame) {
  if (frame.size() < 2) return kNotYet;
  switch (frame[1]) {
    case 0x01:
    case 0x02:
    case 0x03:
    case 0x04:
    case 0x05:
    case 0x06:
    case 0x08: return exactly(8);
    case 0x07: return exactly(4);
    case 0x0F:
    case 0x10: return counted(frame, 6, 9);
    case 0x14:
    case 0x15: return counted(frame, 2, 5);
    case 0x16: return exactly(10);
    case 0x17: return counted(frame, 10, 13);
    case 0x18: return exactly(6);
    case 0x2B: return exactly(7);
    default: return kUnknowable;
  }
}

// 2B 0E code conformity more next objects [object length text..]..
Length identification_length(ByteView frame) {
  std::size_t end = 8;
  if (frame.size() < end) return kNotYet;
  for (unsigned objects = frame[7]; objects > 0; --objects) {
    if (frame.size() < end + 2) return kNotYet;
    end += 2u + frame[end + 1];
  }
  return exactly(end + 2);
}

Length response_length(ByteView frame) {
  if (frame.size() < 2) return kNotYet;
  if ((frame[1] & 0x80u) != 0) return exactly(5);
  switch (frame[1]) {
    case 0x01:
    case 0x02:
    case 0x03:
    case 0x04:
    case 0x14:
    case 0x15:
    case 0x17: return counted(frame, 2, 5);
    case 0x05:
    case 0x06:
    case 0x08:
    case 0x0F:
    case 0x10: return exactly(8);
    case 0x07: return exactly(5);
    case 0x16: return exactly(10);
    case 0x18: return frame.size() < 4 ? kNotYet : exactly(6u + read_u16(frame, 2));
    case 0x2B: return identification_length(frame);
    default: return kUnknowable;
  }
}

bool crc_holds(ByteView frame) { return frame.size() >= 4 && ends_with_crc16(frame); }

// Whether the frame ends with the last received character.
enum class Fit : std::uint8_t { kWhole, kOpen, kNot };
Fit fit(Length length, ByteView frame) {
  if (length.known != Length::Known::kYes) return Fit::kOpen;
  if (length.bytes > kMaxRtuFrame || length.bytes < frame.size()) return Fit::kNot;
  if (length.bytes > frame.size()) return Fit::kOpen;
  return crc_holds(frame) ? Fit::kWhole : Fit::kNot;
}

}  // namespace

// Modbus over Serial Line V1.02, 2.5.1.1: 3.5 characters up to 19200 baud, 1.750 ms above.
RtuReceiver::RtuReceiver(ModbusUnit& unit, const LineFormat& line, bool stream)
    : GapReceiver(line, stream              ? kStreamGap
                        : line.baud > 19200 ? Duration{1'750'000}
                                            : from_seconds(3.5 * 11 / line.baud)),
      unit_(unit) {}

void RtuReceiver::on_character(std::uint8_t character, Instant end, Reaction& reaction) {
  heard(end, reaction);
  if (lost_) return;
  received_.push_back(character);
  const Fit as_request = fit(request_length(received_), received_);
  // Only other units send responses, and none to a broadcast.
  const bool others = received_[0] != 0 && received_[0] != unit_.address();
  const Fit as_response = others ? fit(response_length(received_), received_) : Fit::kNot;
  const bool awaited = requested_.size() == 2 && received_.size() >= 2 &&
                       received_[0] == requested_[0] && received_[1] == requested_[1];
  if (as_request == Fit::kWhole && !others) {
    respond(end, reaction);
    received_.clear();
    requested_.clear();
  } else if (as_response == Fit::kWhole && (awaited || as_request != Fit::kWhole)) {
    received_.clear();
    requested_.clear();
  } else if (as_request == Fit::kWhole && !(awaited && as_response == Fit::kOpen)) {
    requested_.assign(received_.begin(), received_.begin() + 2);
    received_.clear();
  } else if ((as_request == Fit::kNot && as_response == Fit::kNot) ||
             received_.size() >= kMaxRtuFrame) {
    ++unit_.statistics().bad_frames;
    ready(true);
  }
}

// Ends a frame whose function does not determine its length.
void RtuReceiver::on_silence(Instant now, Reaction& reaction) {
  if (!received_.empty()) {
    const bool mine = received_[0] == 0 || received_[0] == unit_.address();
    if (!crc_holds(received_)) {
      ++unit_.statistics().bad_frames;
    } else if (mine) {
      respond(now, reaction);
    }
  }
  ready(false);
}

void RtuReceiver::respond(Instant now, Reaction& reaction) {
  const Bytes pdu = unit_.execute(ByteView(received_).subspan(1, received_.size() - 3), now);
  if (received_[0] == 0) {
    ++unit_.statistics().broadcasts;
    return;
  }
  reaction.response.push_back(unit_.address());
  append(reaction.response, pdu);
  append_crc16(reaction.response);
}

void AsciiReceiver::on_character(std::uint8_t character, Instant end, Reaction& reaction) {
  if (character == ':') {  // starts a frame at any position
    digits_.clear();
    inside_ = true;
  } else if (inside_ && character == '\n') {
    inside_ = false;
    respond(end, reaction);
  } else if (inside_) {
    digits_.push_back(character);
    if (digits_.size() > kMaxAsciiDigits + 1) {  // includes the CR
      ++unit_.statistics().bad_frames;
      inside_ = false;
    }
  }
}

void AsciiReceiver::respond(Instant now, Reaction& reaction) {
  Bytes frame;
  const bool ended = !digits_.empty() && digits_.back() == '\r';
  if (ended) frame = bytes_in(ByteView(digits_).first(digits_.size() - 1)).value_or(Bytes{});
  const bool good =
      frame.size() >= 3 && lrc8(ByteView(frame).first(frame.size() - 1)) == frame.back();
  if (!good) {
    ++unit_.statistics().bad_frames;
    return;
  }
  if (frame[0] != 0 && frame[0] != unit_.address()) return;
  Bytes response{frame[0]};
  append(response, unit_.execute(ByteView(frame).subspan(1, frame.size() - 2), now));
  if (frame[0] == 0) {
    ++unit_.statistics().broadcasts;
    return;
  }
  response.push_back(lrc8(response));
  reaction.response.push_back(':');
  for (const std::uint8_t byte : response) append_hex(reaction.response, byte, 2);
  reaction.response.push_back('\r');
  reaction.response.push_back('\n');
}

void TcpReceiver::on_character(std::uint8_t character, Instant end, Reaction& reaction) {
  frame_.push_back(character);
  if (frame_.size() < kTcpHeader) return;
  const std::size_t length = read_u16(frame_, 4);
  if (read_u16(frame_, 2) != 0 || length < 2 || length > 1 + kMaxPdu) {
    ++unit_.statistics().bad_frames;
    frame_.clear();
    reaction.hang_up = true;  // the start of the next frame is unknown
    return;
  }
  if (frame_.size() < 6 + length) return;
  const bool mine =
      frame_[6] == unit_.address() || (any_unit_ && (frame_[6] == 0 || frame_[6] == 255));
  if (mine) {
    const Bytes pdu = unit_.execute(ByteView(frame_).subspan(kTcpHeader), end);
    reaction.response.assign(frame_.begin(), frame_.begin() + 4);
    append_u16(reaction.response, static_cast<std::uint16_t>(1 + pdu.size()));
    reaction.response.push_back(frame_[6]);
    append(reaction.response, pdu);
  }
  frame_.clear();
}

}  // namespace fieldcast::sim
