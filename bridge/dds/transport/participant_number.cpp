#include "bridge/dds/transport/participant_number.hpp"

#include <algorithm>
#include <cstring>

#include "bridge/dds/guard/participant_message.hpp"
#include "bridge/dds/guard/rtps_message.hpp"

namespace fieldcast {

namespace {

using Span = std::span<const std::uint8_t>;

// RTPS 2.2, 9.4.5.3: 15 flags length | extra(2) to-parameters(2) reader(4) writer(4) number(8),
// parameters: id(2) length(2) value.. The upper half of a number is first.
constexpr std::size_t kPrefix = 8, kPrefixSize = 12, kWriter = kSubmessageHeader + 8;
constexpr std::size_t kParameters = kWriter + 12, kIdAndLength = 4;
constexpr std::uint8_t kHasParameters = 2;
// A parameter of the library: the writer(16) that first wrote this, and its number(8) there.
constexpr std::uint16_t kSampleIdentity = 0x800f, kLastParameter = 1;
constexpr std::size_t kNumberInIdentity = 16, kIdentitySize = 24;
// A server never sends 2^32 messages.
constexpr std::uint32_t kUpperHalf = 1;

std::uint16_t short_at(Span bytes, std::size_t at) {
  std::uint16_t value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

// Offset of the number in a submessage. Returns 0 if it is not an announcement by `prefix`, or not
// in the byte order in which the library writes.
std::size_t number_in(Span part, Span prefix) {
  if (part.size() < kParameters || (part[1] & kHasParameters) == 0 ||
      (part[1] & kLittleEndianFlag) != kOwnOrder ||
      part[0] != static_cast<std::uint8_t>(Submessage::kData) ||
      !std::ranges::equal(part.subspan(kWriter, kParticipantWriter.size()), kParticipantWriter))
    return 0;
  for (std::size_t at = kParameters; at + kIdAndLength <= part.size();) {
    const std::uint16_t id = short_at(part, at), size = short_at(part, at + 2);
    at += kIdAndLength;
    if (id == kLastParameter || at + size > part.size()) return 0;
    if (id == kSampleIdentity) {
      const bool is_own =
          size == kIdentitySize && std::ranges::equal(part.subspan(at, prefix.size()), prefix);
      return is_own ? at + kNumberInIdentity : 0;
    }
    at += size;
  }
  return 0;
}

}  // namespace

std::vector<std::uint8_t> with_number_above_servers(Span message) {
  if (message.size() < kMessageHeader) return {};
  const Span prefix = message.subspan(kPrefix, kPrefixSize);
  std::vector<std::uint8_t> changed;
  for_each_submessage(message, [&](const SubmessageView& one) {
    if (const std::size_t number = number_in(one.bytes, prefix); number != 0) {
      if (changed.empty()) changed.assign(message.begin(), message.end());
      std::memcpy(changed.data() + one.begin + number, &kUpperHalf, sizeof kUpperHalf);
    }
    return true;
  });
  return changed;
}

}  // namespace fieldcast
