#pragma once

#include <cstddef>
#include <cstdint>

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
inline constexpr std::size_t kFinsAnswerBytes = 538;
inline constexpr std::uint16_t kFinsReadWords = 264;
inline constexpr std::uint16_t kFinsReadFlags = 528;
inline constexpr std::uint16_t kFinsWriteWords = 260;
inline constexpr std::uint16_t kFinsItems = 128;  // of command 0104

}  // namespace fieldcast::omron
