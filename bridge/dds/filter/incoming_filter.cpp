#include "bridge/dds/filter/incoming_filter.hpp"

#include <algorithm>
#include <utility>

#include "bridge/dds/guard/rtps_cursor.hpp"
#include "bridge/dds/guard/rtps_message.hpp"

namespace fieldcast {
namespace {

// DDS Security 1.1, 7.3.7.
constexpr EntityBytes kHandshakeWriter{0x00, 0x02, 0x01, 0xc3};
constexpr std::size_t kPrefixOffset = 8;

// No writer sends that many messages, so numbers from here on are reserved for ours.
constexpr std::uint32_t kOurNumbers = 0x40000000;

std::uint32_t word_at(std::span<const std::uint8_t> bytes, std::size_t at, bool little) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | bytes[at + (little ? 3 - i : i)];
  return value;
}

// Offset of the reader and writer identities in a submessage; 0 if it has none.
std::size_t entities_of(Submessage kind) {
  switch (kind) {
    case Submessage::kData:
    case Submessage::kDataFrag: return kSubmessageHeader + 4;
    case Submessage::kAckNack:
    case Submessage::kHeartbeat:
    case Submessage::kGap:
    case Submessage::kNackFrag:
    case Submessage::kHeartbeatFrag: return kSubmessageHeader;
    default: return 0;
  }
}

bool is_harmless(Submessage kind) {
  switch (kind) {
    case Submessage::kPad:
    case Submessage::kInfoTs:
    case Submessage::kInfoDst:
    case Submessage::kSecPrefix:
    case Submessage::kSecBody:
    case Submessage::kSecPostfix: return true;
    default: return kind >= Submessage::kStatistics;
  }
}

std::size_t length_of(std::span<const std::uint8_t> head) {
  const bool little = (head[1] & kLittleEndianFlag) != 0;
  return little ? head[2] | head[3] << 8 : head[2] << 8 | head[3];
}

std::string_view text_of(RtpsCursor& in) {
  const auto bytes = in.take(in.u32());
  in.align();
  if (bytes.empty()) return {};
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size() - 1};  // without its zero
}

// Moves `list` to the value of the parameter, and returns that value; or moves it behind the list.
std::span<const std::uint8_t> parameter(RtpsCursor& list, std::uint16_t wanted) {
  constexpr std::uint16_t kLast = 1;
  while (list.good()) {
    const std::uint16_t id = list.u16(), size = list.u16();
    if (id == kLast) break;
    const auto value = list.take(size);
    if (id == wanted) return value;
  }
  return {};
}

// The subject in the identity token of a participant's announcement (DDS Security 1.1, 7.4.1.3 and
// 9.3.2.1). Empty for other submessages.
std::string_view stated_subject(const SubmessageView& one) {
  constexpr std::uint16_t kIdentityToken = 0x1001;
  constexpr std::uint8_t kHasInlineQos = 2, kHasData = 4;
  RtpsCursor in(one.bytes, one.little);
  in.take(kSubmessageHeader + 2);
  const std::size_t to_parameters = in.u16();
  const std::size_t before = in.at();
  in.take(kParticipantReader.size());
  const auto writer = in.take(kParticipantWriter.size());
  if (one.kind != Submessage::kData || !std::ranges::equal(writer, kParticipantWriter) ||
      (one.bytes[1] & kHasData) == 0)
    return {};
  if (to_parameters < in.at() - before) return {};
  in.take(before + to_parameters - in.at());
  if ((one.bytes[1] & kHasInlineQos) != 0) parameter(in, 0);
  in.take(1);
  const bool little = (in.u8() & kLittleEndianFlag) != 0;  // the list has its own byte order
  in.take(2);
  RtpsCursor list(in.take(in.left()), little);
  RtpsCursor token(parameter(list, kIdentityToken), little);
  text_of(token);  // its class
  for (std::uint32_t left = token.u32(); left > 0 && token.good(); --left) {
    const std::string_view name = text_of(token), value = text_of(token);
    if (name == "dds.cert.sn") return value;
  }
  return {};
}

}  // namespace

bool may_be_in_clear(std::span<const std::uint8_t> message) {
  for (std::size_t at = kMessageHeader; at < message.size();) {
    const auto rest = message.subspan(at);
    if (rest.size() < kSubmessageHeader) return false;
    const auto kind = static_cast<Submessage>(rest[0]);
    if (const std::size_t entities = entities_of(kind); entities != 0) {
      EntityBytes writer{};
      const std::size_t number = entities + 2 * writer.size();
      if (rest.size() < number + sizeof kOurNumbers) return false;
      std::copy_n(rest.begin() + static_cast<std::ptrdiff_t>(entities + writer.size()),
                  writer.size(), writer.begin());
      if (writer != kParticipantWriter && writer != kHandshakeWriter) return false;
      if (kind == Submessage::kData &&
          word_at(rest, number, (rest[1] & kLittleEndianFlag) != 0) >= kOurNumbers)
        return false;
    } else if (!is_harmless(kind)) {
      return false;
    }
    const std::size_t length = length_of(rest);
    // RTPS 2.2, 9.4.5.1.3: the last submessage may have length 0.
    if (length == 0 && kind != Submessage::kPad && kind != Submessage::kInfoTs) break;
    at += kSubmessageHeader + (length + 3) / 4 * 4;
  }
  return true;
}

IncomingFilter::IncomingFilter(bool protects_messages)
    : protects_messages_(protects_messages), number_([] {
        static std::atomic<std::uint64_t> made{0};
        return ++made;
      }()) {}

bool IncomingFilter::is_refused(const Prefix& prefix) const {
  security::GuidStart start{};
  std::copy_n(prefix.begin(), start.size(), start.begin());
  return subjects_.contains(start);
}

std::vector<ParticipantPrefix> IncomingFilter::refuse(const security::GuidStart& subject) {
  const std::lock_guard lock(mutex_);
  std::vector<Prefix> present;
  if (!subjects_.insert(subject).second) return present;
  refuses_ = true;
  for (const Prefix& prefix : participants_) {
    if (std::equal(subject.begin(), subject.end(), prefix.begin())) present.push_back(prefix);
  }
  refused_.insert(refused_.end(), present.begin(), present.end());
  refused_participants_ = refused_.size();
  return present;
}

bool IncomingFilter::takes(std::span<const std::uint8_t> message) {
  if (message.size() < kMessageHeader) return false;
  Prefix prefix{};
  std::copy_n(message.begin() + kPrefixOffset, prefix.size(), prefix.begin());
  {
    const std::lock_guard lock(mutex_);
    if (refuses_ && is_refused(prefix)) return false;
    // present participants send again
    if (participants_.size() >= kMaxParticipants) participants_.clear();
    participants_.insert(prefix);
  }
  const bool is_protected =
      message.size() > kMessageHeader &&
      static_cast<Submessage>(message[kMessageHeader]) == Submessage::kSrtpsPrefix;
  if (is_protected) return true;
  note_subject(prefix, message);
  if (!protects_messages_ || may_be_in_clear(message)) return true;
  ++refused_in_clear_;
  return false;
}

void IncomingFilter::note_subject(const Prefix& prefix, std::span<const std::uint8_t> message) {
  for_each_submessage(message, [&](const SubmessageView& one) {
    const std::string_view stated = stated_subject(one);
    if (stated.empty()) return true;
    const auto subject = security::subject_from(stated);
    if (!subject) return true;
    const security::GuidStart start = security::guid_start(*subject);
    if (!std::equal(start.begin(), start.end(), prefix.begin())) return true;
    const std::lock_guard lock(mutex_);
    if (stated_.size() >= kMaxParticipants) stated_.clear();  // present participants repeat theirs
    stated_[prefix] = stated;
    return true;
  });
}

std::string IncomingFilter::subject_of(const ParticipantPrefix& participant) const {
  const std::lock_guard lock(mutex_);
  const auto found = stated_.find(participant);
  return found == stated_.end() ? std::string() : found->second;
}

std::vector<IncomingFilter::Bytes> IncomingFilter::goodbyes() {
  // A transport thread serves one participant at a time.
  thread_local std::uint64_t of = 0;
  thread_local std::size_t told = 0;
  if (refused_participants_ == 0) return {};
  if (std::exchange(of, number_) != number_) told = 0;
  if (told == refused_participants_) return {};
  const std::lock_guard lock(mutex_);
  std::vector<Bytes> all;
  for (; told < refused_.size(); ++told) all.push_back(goodbye(refused_[told]));
  return all;
}

IncomingFilter::Bytes IncomingFilter::goodbye_of_sender(std::span<const std::uint8_t> message) {
  if (!refuses_ || message.size() < kMessageHeader) return {};
  Prefix prefix{};
  std::copy_n(message.begin() + kPrefixOffset, prefix.size(), prefix.begin());
  const std::lock_guard lock(mutex_);
  return is_refused(prefix) ? goodbye(prefix) : Bytes{};
}

// The library ignores numbers of a writer that are not above the last one, and may_be_in_clear()
// rejects numbers as high as ours.
IncomingFilter::Bytes IncomingFilter::goodbye(const Prefix& prefix) {
  return participant_gone(prefix, std::uint64_t{kOurNumbers} << 32 | ++goodbyes_);
}

}  // namespace fieldcast
