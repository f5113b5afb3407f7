// The structure of an RTPS message (RTPS 2.2, 9.4): a header, then submessages, each with a header
// of kind, flags and length.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace fieldcast {

inline constexpr std::size_t kMessageHeader = 20, kSubmessageHeader = 4;  // bytes

// 9.4.5.1.1
enum class Submessage : std::uint8_t {
  kPad = 0x01,
  kAckNack = 0x06,
  kHeartbeat = 0x07,
  kGap = 0x08,
  kInfoTs = 0x09,
  kInfoSource = 0x0c,
  kInfoReplyIp4 = 0x0d,
  kInfoDst = 0x0e,
  kInfoReply = 0x0f,
  kNackFrag = 0x12,
  kHeartbeatFrag = 0x13,
  kData = 0x15,
  kDataFrag = 0x16,
  // vendor-specific, like all values from here on: Fast DDS counts messages in it
  kStatistics = 0x80,
  // Of DDS Security 1.1 (OMG formal/18-04-01, 7.3.6).
  kSecBody = 0x30,
  kSecPrefix = 0x31,
  kSecPostfix = 0x32,
  kSrtpsPrefix = 0x33,  // the whole message is protected
  kSrtpsPostfix = 0x34,
};

// The flag of every submessage for its byte order, and the value that the library writes: the order
// of this machine.
inline constexpr std::uint8_t kLittleEndianFlag = 1;
inline constexpr std::uint8_t kOwnOrder =
    std::endian::native == std::endian::little ? kLittleEndianFlag : 0;

struct SubmessageView {
  Submessage kind{};
  bool little = false;  // byte order of the submessage
  std::size_t begin = 0;
  std::span<const std::uint8_t> bytes;  // including its header
};

// Calls `each` for each submessage of any bytes, while it returns true. Stops at a submessage that
// is longer than the message.
template <class Each>
void for_each_submessage(std::span<const std::uint8_t> message, Each each) {
  for (std::size_t begin = kMessageHeader; begin + kSubmessageHeader <= message.size();) {
    const auto rest = message.subspan(begin);
    SubmessageView one{static_cast<Submessage>(rest[0]), (rest[1] & kLittleEndianFlag) != 0, begin,
                       rest};
    const std::size_t length = one.little ? rest[2] | rest[3] << 8 : rest[2] << 8 | rest[3];
    // 9.4.5.1.3: 0 means to the end of the message, except for kinds that may be empty.
    if (length != 0 || one.kind == Submessage::kPad || one.kind == Submessage::kInfoTs) {
      if (kSubmessageHeader + length > rest.size()) return;
      one.bytes = rest.first(kSubmessageHeader + length);
    }
    if (!each(one)) return;
    begin += one.bytes.size();
  }
}

}  // namespace fieldcast
