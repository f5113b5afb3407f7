// The structure of an RTPS message (RTPS 2.2, 9.4): header, then submessages.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

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

// The byte order flag of a submessage, and the value for this machine, which the library writes.
inline constexpr std::uint8_t kLittleEndianFlag = 1;
inline constexpr std::uint8_t kOwnOrder =
    std::endian::native == std::endian::little ? kLittleEndianFlag : 0;

struct SubmessageView {
  Submessage kind{};
  bool little = false;  // byte order of the submessage
  std::size_t begin = 0;
  std::span<const std::uint8_t> bytes;  // including its header
};

// Calls `each` for each submessage while it returns true. Stops at one longer than the message.
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

// Causes for which the guard refuses a datagram, and its limits. Plain values; any thread.
enum class RtpsFault : std::uint8_t {
  kHeader,          // not an RTPS 2 message
  kSubmessage,      // a length or flag that contradicts its content
  kOrder,           // a submessage where RTPS or DDS Security does not allow it
  kSequenceNumber,  // zero, negative, or a range that runs backwards
  kBitmap,          // a set of numbers longer than 256 or than its submessage
  kGap,             // a range of irrelevant samples that would fill the reader's memory
  kFragment,        // fragment numbers and sizes that contradict the sample
  kSampleSize,      // a sample above the limit
  kParameterList,   // a list without end, a parameter longer than the list
  kParameter,       // a parameter whose content contradicts its length, or is above a limit
  kEncapsulation,   // an unknown form of the payload
  kService,         // a built-in service of the library that Fieldcast does not use
  kSender,          // discovery in the name of a participant from another address
  kParticipants,    // more participants than the limit
  kJoinRate,        // more new participants a second than the limit
  kEndpoints,       // more endpoints of a participant, or in all, than the limit
  kFragmentMemory,  // more bytes of unfinished samples than the limit
};
inline constexpr std::size_t kRtpsFaults = 17;
using RtpsFaultCounts = std::array<std::uint64_t, kRtpsFaults>;

// "HEADER", "SUBMESSAGE", ..: the word for logs, status and metrics.
[[nodiscard]] std::string_view to_text(RtpsFault fault);

// The defaults are far above what 200 participants of a plant need. The largest type of
// idl/fieldcast.idl has 550 000 bytes.
struct RtpsLimits {
  std::uint32_t sample_bytes = 1 << 20;     // of a fragmented sample
  std::uint32_t fragment_bytes = 32 << 20;  // of fragmented samples that begin within 10 s
  std::uint32_t participants = 1024;        // at a time
  std::uint32_t joins_per_second = 200;     // of one address; bursts of four times as many
  std::uint32_t endpoints = 8192;           // of one participant
  std::uint32_t endpoints_in_all = 65536;   // of all participants
  bool secured = false;                     // DDS Security: protected parts are read as they are
  bool relayed = false;  // a discovery server may announce entities of other participants
  friend bool operator==(const RtpsLimits&, const RtpsLimits&) = default;
};

}  // namespace fieldcast
