// Causes for which the guard refuses a datagram before the DDS library reads it, and the limits
// that it applies. Plain values; any thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace fieldcast {

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
  bool relayed = false;  // a discovery server may announce entities of other participants
  friend bool operator==(const RtpsLimits&, const RtpsLimits&) = default;
};

}  // namespace fieldcast
