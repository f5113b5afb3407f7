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
//                 LS:                       request for the list of devices (ours). A device number
//                                           has no colon, so other bridges reply 0001
//                 ED                        stop, release the device; after a list, disconnect
//     bridge      0000 .. 0003, 0004        the replies; 0004 is ours: no login, or no programmer
//                 LD number : state : bus : device : who
//                                           a device of the list (ours, device_list.hpp). state: 0
//                                           free, 1 in use, 2 not online; bus, device and who in
//                                           hexadecimal digits as above; who may be empty
//                 LE count                  the list ends (ours); count: devices that may be
//                                           programmed, at least the number of LD frames
//     both        HB                        heartbeat
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "core/base/bytes.hpp"
#include "core/frame/line.hpp"

namespace fieldcast::program {

inline constexpr std::string_view kFrameStart = "@@", kFrameEnd = "FEFF";
inline constexpr std::string_view kInstructionEnd = "\rFEFF";
inline constexpr std::string_view kStopCode = "ED", kHeartbeatCode = "HB";
inline constexpr std::string_view kLengthCode = "V2", kLoginCode = "AU", kListCode = "LS:";
inline constexpr std::string_view kListedCode = "LD", kListEndCode = "LE";
// Counts the end character; longer instructions are dropped and reported.
inline constexpr std::size_t kMaxInstruction = 4096;
// A login with 128 characters of user and of password, or the longest device of a list.
inline constexpr std::size_t kMaxHandshakeCode = 700;
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

// Text as lower-case hexadecimal digits, as in the frames of a login and of a list.
[[nodiscard]] std::string hex_of_text(std::string_view text);
// Empty if `digits` has an odd length or another character.
[[nodiscard]] std::optional<std::string> text_of_hex(std::string_view digits);
// Returns true if the text can be a name in one line of a log, of the audit and of a list: it is
// not empty and has no control character.
[[nodiscard]] bool is_name_in_line(std::string_view text);

[[nodiscard]] inline std::string_view as_text(ByteView bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}
[[nodiscard]] inline ByteView as_bytes(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

// Number of a device for engineers and dial-in modules: 1 to 16 letters or digits.
inline constexpr std::size_t kMaxDeviceNumber = 16;

// Returns true if no frame can confuse it with another code: not `ED`, `HB` or a reply (four digits
// that begin with 000), without the marker `FEFF`, and not beginning with `V2`, which requests
// framing by length.
[[nodiscard]] bool is_device_number(std::string_view text);

inline constexpr std::string_view kDeviceNumberForm =
    "1 to 16 letters or digits; not ED, not HB, not 000 and a digit, not beginning with V2, "
    "without FEFF";

// Framing used by our own client: carries any bytes, without search or delay.
//
//     length(4) bytes       1 .. kMaxChunk, big-endian
//     00000000              heartbeat
//     FFFFFFFF              stop; the bridge may add the reason as a marker frame (@@0003FEFF)
//     FFFFFFFE baud(4) stop(1) data(1) parity(1)
//                           settings of the real line, client to bridge (ours)
//
// baud 0 keeps the configured baud rate, data 0 the configured data bits and parity. parity: 0
// none, 1 even, 2 odd.

// A larger length means that the stream is out of step.
inline constexpr std::uint32_t kMaxChunk = 65536;

struct ChunkBytes {
  ByteView bytes;  // refers to the input; may be a part of a chunk
};
struct Heartbeat {};
struct Stop {};
using LengthFrame = std::variant<ChunkBytes, Heartbeat, Stop, LineSettings, FrameFault>;

class LengthReader {
 public:
  // Consumes a frame from the front of `in`, or returns empty. Stop or a fault ends the stream.
  [[nodiscard]] std::optional<LengthFrame> next(ByteView& in);
  [[nodiscard]] bool partial() const { return left_ > 0 || !head_.empty(); }

 private:
  Bytes head_;              // received part of a head
  std::uint32_t left_ = 0;  // of the chunk
};

void append_chunks(Bytes& out, ByteView bytes);
// A heartbeat or a stop in either framing.
[[nodiscard]] Bytes heartbeat_frame(bool by_length);
[[nodiscard]] Bytes stop_frame(bool by_length);
void append_settings(Bytes& out, const LineSettings& settings);

}  // namespace fieldcast::program
