#include "bridge/dds/filter/unregister_message.hpp"

#include <cstring>

#include "bridge/dds/guard/rtps_message.hpp"

namespace fieldcast {

namespace {

// RTPS 2.2, 9.4.5.1 and 9.4.5.3: 15 flags length(2) | extra(2) to-inline-qos(2) reader(4) writer(4)
// sequence(8) inline-qos.. payload..
constexpr std::size_t kParameterHeader = 4;
constexpr std::uint8_t kInlineQos = 2, kDataPayload = 4, kKeyPayload = 8;
// RTPS 2.2, 9.6.2.2.2 and 9.6.3; the mark is a parameter of Fast DDS.
constexpr std::uint16_t kKeyHash = 0x70, kStatusInfo = 0x71, kSentinel = 1, kMark = 0x800f;
constexpr std::uint16_t kKeyHashSize = 16, kStatusInfoSize = 4, kMarkSize = 24;
constexpr std::uint8_t kUnregistered = 2;
static_assert(kMarkSize == kKeyHashSize + kParameterHeader + kStatusInfoSize);

// No writer reaches this sequence number.
constexpr std::int32_t kMarkHigh = 0x46436E6F;
constexpr std::uint32_t kMarkLow = 0x74652E31;

template <class T>
T at(std::span<const std::uint8_t> bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

bool is_mark(std::span<const std::uint8_t> message, std::size_t parameter) {
  const std::size_t sequence = parameter + kParameterHeader + rtps::GUID_t{}.guidPrefix.size + 4;
  return at<std::uint16_t>(message, parameter) == kMark &&
         at<std::uint16_t>(message, parameter + 2) == kMarkSize &&
         at<std::int32_t>(message, sequence) == kMarkHigh &&
         at<std::uint32_t>(message, sequence + 4) == kMarkLow;
}

// Offset of the mark in the submessage of [begin, end); 0 if there is none.
std::size_t find_mark(std::span<const std::uint8_t> message, std::size_t begin, std::size_t end) {
  const std::uint8_t flags = message[begin + 1];
  if (message[begin] != static_cast<std::uint8_t>(Submessage::kData) ||
      (flags & kLittleEndianFlag) != kOwnOrder || !(flags & kInlineQos) ||
      !(flags & kDataPayload) || end < begin + kSubmessageHeader + 20)
    return 0;
  std::size_t parameter =
      begin + kSubmessageHeader + 4 + at<std::uint16_t>(message, begin + kSubmessageHeader + 2);
  while (parameter + kParameterHeader <= end) {
    const auto id = at<std::uint16_t>(message, parameter);
    const std::size_t next =
        parameter + kParameterHeader + at<std::uint16_t>(message, parameter + 2);
    if (id == kSentinel || next > end) return 0;
    if (is_mark(message, parameter)) return parameter;
    parameter = next;
  }
  return 0;
}

// Calls `found` for each marked submessage with its offset and that of its mark. Stops when `found`
// returns false.
template <class Found>
void for_each_mark(std::span<const std::uint8_t> message, Found found) {
  if (message.size() < kMessageHeader || std::memcmp(message.data(), "RTPS", 4) != 0) return;
  for_each_submessage(message, [&](const SubmessageView& one) {
    const std::size_t mark = find_mark(message, one.begin, one.begin + one.bytes.size());
    return mark == 0 || found(one.begin, mark);
  });
}

}  // namespace

rtps::SampleIdentity unregister_mark(const rtps::InstanceHandle_t& key) {
  rtps::GUID_t hash;
  for (std::size_t i = 0; i < kKeyHashSize; ++i) {
    (i < rtps::GuidPrefix_t::size ? hash.guidPrefix.value[i]
                                  : hash.entityId.value[i - rtps::GuidPrefix_t::size]) =
        key.value[i];
  }
  rtps::SampleIdentity mark;
  mark.writer_guid(hash);
  mark.sequence_number(rtps::SequenceNumber_t(kMarkHigh, kMarkLow));
  return mark;
}

bool holds_marks(std::span<const std::uint8_t> message) {
  bool some = false;
  for_each_mark(message, [&](std::size_t, std::size_t) {
    some = true;
    return false;
  });
  return some;
}

void turn_marks_into_notes(std::span<std::uint8_t> message) {
  for_each_mark(message, [&](std::size_t begin, std::size_t mark) {
    const auto put = [&](std::size_t offset, std::uint16_t id, std::uint16_t size) {
      std::memcpy(message.data() + offset, &id, sizeof id);
      std::memcpy(message.data() + offset + 2, &size, sizeof size);
    };
    put(mark, kKeyHash, kKeyHashSize);  // its 16 bytes are already in place
    const std::size_t status = mark + kParameterHeader + kKeyHashSize;
    put(status, kStatusInfo, kStatusInfoSize);
    const std::uint8_t unregistered[kStatusInfoSize] = {0, 0, 0, kUnregistered};
    std::memcpy(message.data() + status + kParameterHeader, unregistered, sizeof unregistered);
    message[begin + 1] =
        static_cast<std::uint8_t>((message[begin + 1] & ~kDataPayload) | kKeyPayload);
    return true;
  });
}

}  // namespace fieldcast
