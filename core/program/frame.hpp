// Frames between an engineer's client and the bridge. "Ours" marks extensions of Fieldcast.
//
//     frame       @@ code FEFF              control: a code of the table below
//     frame       @@ instruction CR FEFF    program bytes: one instruction with its end character
//
//     client      device number             request for a device (marker framing)
//                 V2 device number          the same; after 0000 both sides use length framing
//                                           (length_framing.hpp)
//                 AU user : password        login, both in lower-case hexadecimal digits, which
//                                           never contain FEFF (ours)
//                 ED                        stop, release the device
//     bridge      0000 .. 0003, 0004        the replies; 0004 is ours: no login, or no programmer
//     both        HB                        heartbeat
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/bytes.hpp"
#include "core/frame/line.hpp"

namespace fieldcast::program {

inline constexpr std::string_view kFrameStart = "@@", kFrameEnd = "FEFF";
inline constexpr std::string_view kInstructionEnd = "\rFEFF";
inline constexpr std::string_view kStopCode = "ED", kHeartbeatCode = "HB";
inline constexpr std::string_view kLengthCode = "V2", kLoginCode = "AU";
// Counts the end character; longer instructions are dropped and reported.
inline constexpr std::size_t kMaxInstruction = 4096;
// A login with 128 characters of user and of password.
inline constexpr std::size_t kMaxHandshakeCode = 600;
inline constexpr std::size_t kMaxLoginText = 128;

enum class Reply : std::uint8_t { kPaired, kNotOnline, kInUse, kLost, kNotAllowed };
[[nodiscard]] std::string_view to_code(Reply reply);  // "0000"
[[nodiscard]] std::string_view to_text(Reply reply);  // human-readable
[[nodiscard]] std::optional<Reply> reply_from(std::string_view code);

// Each end has its own codes in transmission.
enum class Sender : std::uint8_t { kClient, kBridge };

enum class Opening : std::uint8_t { kProgram, kControl, kUndecided };
struct FrameOpening {
  Opening what = Opening::kProgram;
  std::string_view code;  // kControl and kUndecided: the certain or possible code
};
// `text`: the received part of the frame after `@@`. kUndecided also while FEFF itself is missing.
[[nodiscard]] FrameOpening opening_of(std::string_view text, Sender sender);

// Reading continues after a fault, if the stream is not lost.
enum class FrameFault : std::uint8_t {
  kNoise,    // bytes outside of any frame
  kTooLong,  // a dropped instruction of more than kMaxInstruction characters
  kHalf,     // a dropped incomplete instruction
  // A dropped instruction that looks like a control frame followed by another frame.
  kAmbiguous,
  kBadLength,  // an invalid length; the stream cannot continue
  kBadLine,    // invalid line settings; the stream cannot continue
};
[[nodiscard]] std::string_view to_text(FrameFault fault);

// Settings of the real line of a pairing. A pseudo-terminal reports the baud rate and the stop bits
// set by a program, but neither data bits nor parity (Linux, pty_set_termios). The engineer passes
// these to the client, or they stay as configured.
struct LineSettings {
  std::uint32_t baud = 0;  // 0: as configured in the bridge
  std::uint8_t stop_bits = 1;
  // 7 or 8; 0: data bits and parity as configured in the bridge.
  std::uint8_t data_bits = 0;
  Parity parity = Parity::kNone;
  friend bool operator==(const LineSettings&, const LineSettings&) = default;
};

// "@@" code "FEFF".
[[nodiscard]] Bytes control_frame(std::string_view code);

[[nodiscard]] inline std::string_view as_text(ByteView bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}
[[nodiscard]] inline ByteView as_bytes(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

}  // namespace fieldcast::program
