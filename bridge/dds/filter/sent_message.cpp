#include "bridge/dds/filter/sent_message.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <optional>

#include "bridge/base/check.hpp"
#include "bridge/dds/guard/rtps_message.hpp"

namespace fieldcast {

namespace {

// Resets the destination to every participant (RTPS 2.2, 9.4.5.8, with GUIDPREFIX_UNKNOWN).
constexpr std::array<std::uint8_t, 16> kToAll = {static_cast<std::uint8_t>(Submessage::kInfoDst),
                                                 kOwnOrder, kOwnOrder == kLittleEndianFlag ? 12 : 0,
                                                 kOwnOrder == kLittleEndianFlag ? 0 : 12};

// The content of a message after its header.
struct Content {
  std::size_t end = kMessageHeader;  // of the part before the statistics
  std::optional<Submessage> first;
  bool directed = false;
};

std::uint16_t length_at(std::span<const std::uint8_t> message, std::size_t begin) {
  std::uint16_t length;
  std::memcpy(&length, message.data() + begin + 2, sizeof length);
  return length;
}

// Returns `std::nullopt` for a message that cannot be appended to another message.
std::optional<Content> content_of(std::span<const std::uint8_t> message) {
  if (message.size() < kMessageHeader || std::memcmp(message.data(), "RTPS", 4) != 0)
    return std::nullopt;
  Content content;
  bool timed = false;
  for (std::size_t begin = kMessageHeader; begin != message.size();) {
    if (begin + kSubmessageHeader > message.size()) return std::nullopt;
    const auto kind = static_cast<Submessage>(message[begin]);
    const std::uint16_t length = length_at(message, begin);
    const std::size_t end = begin + kSubmessageHeader + length;
    // A length of 0 may mean "to the end", and each submessage begins at a multiple of 4 (9.4.1,
    // 9.4.5.1.3).
    if ((message[begin + 1] & kLittleEndianFlag) != kOwnOrder || length == 0 || length % 4 != 0 ||
        end > message.size())
      return std::nullopt;
    switch (kind) {
      case Submessage::kInfoTs: timed = true; break;
      case Submessage::kInfoDst: content.directed = true; break;
      case Submessage::kData:
        if (!timed) return std::nullopt;  // it would get the timestamp of the message before it
        break;
      case Submessage::kPad:
      case Submessage::kHeartbeat:
      case Submessage::kGap: break;
      case Submessage::kStatistics:
        if (end != message.size()) return std::nullopt;
        return content.first ? std::optional(content) : std::nullopt;
      default: return std::nullopt;
    }
    if (!content.first) content.first = kind;
    content.end = begin = end;
  }
  return content.first ? std::optional(content) : std::nullopt;
}

}  // namespace

bool JoinedMessage::append(std::span<const std::uint8_t> message) {
  const auto content = content_of(message);
  if (!content) return false;
  const std::size_t skipped = bytes_.empty() ? 0 : kMessageHeader;
  const bool redirect = directed_ && content->first != Submessage::kInfoDst;
  if (bytes_.size() + (redirect ? kToAll.size() : 0) + message.size() - skipped > most_bytes_)
    return false;
  if (!bytes_.empty() &&
      !std::equal(bytes_.begin(), bytes_.begin() + kMessageHeader, message.begin()))
    return false;
  if (redirect) bytes_.insert(bytes_.end(), kToAll.begin(), kToAll.end());
  const auto at = [&](std::size_t offset) {
    return message.begin() + static_cast<std::ptrdiff_t>(offset);
  };
  bytes_.insert(bytes_.end(), at(skipped), at(content->end));
  tail_.assign(at(content->end), message.end());
  directed_ = content->directed || (directed_ && !redirect);
  return true;
}

std::span<const std::uint8_t> JoinedMessage::whole() {
  bytes_.insert(bytes_.end(), tail_.begin(), tail_.end());
  tail_.clear();
  return bytes_;
}

void JoinedMessage::clear() {
  bytes_.clear();
  tail_.clear();
  directed_ = false;
}

namespace {

thread_local JoinedSending* of_thread = nullptr;

// Messages are not joined if statistics are on, because the library counts its own messages.
bool wants_statistics() {
  // NOLINTNEXTLINE(concurrency-mt-unsafe): nothing sets the environment
  static const bool wanted = std::getenv("FASTDDS_STATISTICS") != nullptr;
  return wanted;
}

}  // namespace

JoinedSending::JoinedSending(std::size_t most_bytes) : most_bytes_(most_bytes) {
  FIELDCAST_CHECK(of_thread == nullptr);
  if (!wants_statistics()) of_thread = this;
}

JoinedSending::~JoinedSending() {
  of_thread = nullptr;
  for (Kept& kept : kept_) let_go(kept);
}

JoinedSending* JoinedSending::of_this_thread() { return of_thread; }

bool JoinedSending::send(PassingTransport& transport, const OutgoingMessage& message) {
  to_.clear();
  for (auto& at = *message.begin; at != *message.end; ++at) to_.push_back(*at);
  auto kept = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& one) {
    return one.below == message.below && one.to == to_;
  });
  if (kept == kept_.end()) {
    kept_.push_back({&transport, message.below, to_, message.deadline, JoinedMessage(most_bytes_)});
    kept = std::prev(kept_.end());
  }
  kept->deadline = message.deadline;
  if (kept->message.append(message.bytes)) return true;
  let_go(*kept);
  if (kept->message.append(message.bytes)) return true;
  rtps_transport::Locators begin(to_.begin()), end(to_.end());
  return transport.send_whole({message.below, message.bytes, &begin, &end, message.deadline});
}

void JoinedSending::let_go(Kept& kept) {
  if (kept.message.empty()) return;
  rtps_transport::Locators begin(kept.to.begin()), end(kept.to.end());
  // A failure cannot be reported here; the writers repeat unacknowledged messages.
  (void)kept.transport->send_whole({kept.below, kept.message.whole(), &begin, &end, kept.deadline});
  kept.message.clear();
}

namespace {

// RTPS 2.2, 9.4.5.1 and 9.4.5.3: 15 flags length(2) | extra(2) to-inline-qos(2) reader(4) writer(4)
// sequence(8) inline-qos.. payload..
constexpr std::size_t kParameterHeader = 4;
constexpr std::uint8_t kInlineQos = 2, kDataPayload = 4, kKeyPayload = 8;
// RTPS 2.2, 9.6.2.2.2 and 9.6.3; the mark is a parameter of Fast DDS.
constexpr std::uint16_t kKeyHash = 0x70, kStatusInfo = 0x71, kSentinel = 1, kMark = 0x800f;
constexpr std::uint16_t kPad = 0;
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

// Offset of the first inline parameter for which `wanted(offset)` is true, in the submessage of
// [begin, end) that has a payload; 0 if there is none.
template <class Wanted>
std::size_t find_parameter(std::span<const std::uint8_t> message, std::size_t begin,
                           std::size_t end, Wanted wanted) {
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
    if (wanted(parameter)) return parameter;
    parameter = next;
  }
  return 0;
}

// Calls `found` for each marked submessage with its view and the offset of its mark, until it
// returns false.
template <class Found>
void for_each_mark(std::span<const std::uint8_t> message, Found found) {
  if (message.size() < kMessageHeader || std::memcmp(message.data(), "RTPS", 4) != 0) return;
  for_each_submessage(message, [&](const SubmessageView& one) {
    const std::size_t mark =
        find_parameter(message, one.begin, one.begin + one.bytes.size(),
                       [&](std::size_t parameter) { return is_mark(message, parameter); });
    return mark == 0 || found(one, mark);
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
  for_each_mark(message, [&](const SubmessageView&, std::size_t) {
    some = true;
    return false;
  });
  return some;
}

void turn_marks_into_notes(std::span<std::uint8_t> message) {
  for_each_mark(message, [&](const SubmessageView& one, std::size_t mark) {
    // Fast DDS 3 adds the key hash to each message, and a parameter must not occur twice.
    const bool has_hash = find_parameter(message, one.begin, one.begin + one.bytes.size(),
                                         [&](std::size_t parameter) {
                                           return at<std::uint16_t>(message, parameter) == kKeyHash;
                                         }) != 0;
    const auto put = [&](std::size_t offset, std::uint16_t id, std::uint16_t size) {
      std::memcpy(message.data() + offset, &id, sizeof id);
      std::memcpy(message.data() + offset + 2, &size, sizeof size);
    };
    put(mark, has_hash ? kPad : kKeyHash, kKeyHashSize);  // its 16 bytes are already in place
    const std::size_t status = mark + kParameterHeader + kKeyHashSize;
    put(status, kStatusInfo, kStatusInfoSize);
    const std::uint8_t unregistered[kStatusInfoSize] = {0, 0, 0, kUnregistered};
    std::memcpy(message.data() + status + kParameterHeader, unregistered, sizeof unregistered);
    std::uint8_t& flags = message[one.begin + 1];
    flags = static_cast<std::uint8_t>((flags & ~kDataPayload) | kKeyPayload);
    return true;
  });
}

}  // namespace fieldcast
