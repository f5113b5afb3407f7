#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/base/bytes.hpp"
#include "core/base/cause.hpp"
#include "core/protocol/device_code.hpp"
#include "core/protocol/protocol.hpp"
#include "core/protocol/received.hpp"

namespace fieldcast::omron {

// C-mode: at most 131 characters with the terminator, then a delimiter from the receiver (W227). In
// data characters per frame:
inline constexpr std::uint32_t kReadFirst = 120, kReadLater = 124;    // 30 words, then 31
inline constexpr std::uint32_t kFlagsFirst = 121, kFlagsLater = 124;  // one character each
inline constexpr std::uint32_t kWriteFirst = 116, kWriteLater = 124;  // 29 words, then 31

// At most eight frames per request: with more, a lost character costs too much.
inline constexpr std::uint16_t kCReadWords = 30 + 7 * 31;
inline constexpr std::uint16_t kCWriteWords = 29 + 7 * 31;
inline constexpr std::uint16_t kCReadFlags = 121 + 124;
inline constexpr std::uint16_t kCWriteFlags = 116;

// FINS: 540 bytes of request, 538 of response. A relayed message has six more bytes of header.
inline constexpr std::size_t kFinsRequestBytes = 540;
inline constexpr std::size_t kFinsResponseBytes = 538;
inline constexpr std::uint16_t kFinsReadWords = 264;
inline constexpr std::uint16_t kFinsReadFlags = 528;
inline constexpr std::uint16_t kFinsWriteWords = 260;
inline constexpr std::uint16_t kFinsItems = 128;  // of command 0104

// FINS on Ethernet: messages of 2012 bytes (W421, 7-2; W342, 5-3-2 to 5-3-5).
inline constexpr std::size_t kEthernetBytes = 2012;
inline constexpr std::uint16_t kEthernetReadWords = 999, kEthernetWriteWords = 996;
inline constexpr std::uint16_t kEthernetReadFlags = 1998;
inline constexpr std::uint16_t kEthernetItems = 167;

// The Host Link frame, shared by C-mode and FINS.
//
//     first or only   @ uu HH text FCS * CR    uu: unit 00..31 in decimal; HH: header
//     later           text FCS * CR
//     delimiter       CR                       from the receiver of a frame without `*`
//
// A frame that others follow has no `*`. FCS: XOR of all preceding characters of the frame, as two
// digits (Omron W227, 1-2).
inline constexpr std::uint8_t kAt = '@', kStar = '*', kCr = '\r';
inline constexpr std::size_t kFcsSize = 2;
inline constexpr std::size_t kHeadSize = 5;  // @ uu HH
inline constexpr std::size_t kEndCodeSize = 2;
inline constexpr std::uint16_t kNotSupported = 0x16;  // end code, reported for a response IC

// "@uuHH".
void append_head(Bytes& out, std::uint16_t unit, std::string_view header);
// Appends the FCS over `out` from `start`, `*` if the frame is the last, and CR.
void append_end(Bytes& out, std::size_t start, bool last);

[[nodiscard]] constexpr std::size_t end_size(bool last) { return kFcsSize + (last ? 2 : 1); }

struct ParseResult {
  enum class Kind : std::uint8_t { kNothing, kOpen, kBroken, kFrame };
  Kind kind = Kind::kNothing;
  bool last = false;    // kFrame: with `*`
  ByteView text;        // kFrame: without FCS and end, with `@`; kOpen: the received part
  std::size_t end = 0;  // kFrame, kBroken: offset after the CR
};

// First frame that begins with `@`; another `@` restarts it, earlier characters are noise.
[[nodiscard]] ParseResult first_frame(ByteView bytes);
[[nodiscard]] ParseResult later_frame(ByteView bytes);

// Searches a response of `expected` characters: returns the first step of `judge(frame)` that ends
// the wait. `silence` becomes the cause that applies if no more bytes arrive.
template <typename Judge>
[[nodiscard]] Step search_frames(ByteView all, std::size_t expected, Cause& silence, Judge judge) {
  silence = cause_of_noise(all);
  Step step = Step::need_response();
  for (;;) {
    const ParseResult parsed = first_frame(all);
    if (parsed.kind == ParseResult::Kind::kNothing) return step;
    if (parsed.kind == ParseResult::Kind::kOpen) {
      silence = Cause::kTruncated;
      return Step::need_rest(expected > parsed.text.size() ? expected - parsed.text.size() : 1);
    }
    if (parsed.kind == ParseResult::Kind::kBroken) {
      silence = Cause::kChecksum;
      step = Step::need_rest(0);
    } else {
      step = judge(parsed);
      if (step.kind != Step::Kind::kNeedMore) return step;
    }
    all = all.subspan(parsed.end);
  }
}

// End codes of Host Link frames (W342, 4-3). Requests are sent with a valid FCS: if the PLC reports
// a wrong one, the line damaged them, and they may be sent again. A CPU mode that forbids the
// command, and a CPU error, are temporary.
inline constexpr std::array kEndCodes{
    DeviceCode{0x00, "normal completion"},
    DeviceCode{0x01, "not executable in RUN mode", Cause::kDeviceBusy},
    DeviceCode{0x02, "not executable in MONITOR mode", Cause::kDeviceBusy},
    DeviceCode{0x03, "program memory protected"},
    DeviceCode{0x04, "address over"},
    DeviceCode{0x0B, "not executable in PROGRAM mode", Cause::kDeviceBusy},
    DeviceCode{0x13, "FCS error", Cause::kChecksum},
    DeviceCode{0x14, "format error"},
    DeviceCode{0x15, "entry number data error"},
    DeviceCode{0x16, "command not supported"},
    DeviceCode{0x18, "frame length error"},
    DeviceCode{0x19, "not executable"},
    DeviceCode{0x20, "I/O table not made"},
    DeviceCode{0x21, "CPU unit error", Cause::kDeviceBusy},
    DeviceCode{0x23, "user memory protected"},
    DeviceCode{0xA3, "aborted: FCS error in the data", Cause::kChecksum},
    DeviceCode{0xA4, "aborted: format error in the data"},
    DeviceCode{0xA5, "aborted: entry number error in the data"},
    DeviceCode{0xA8, "aborted: frame length error in the data"},
};
// "FCS error"; "unknown end code".
[[nodiscard]] std::string_view end_code_text(std::uint16_t code);

}  // namespace fieldcast::omron
