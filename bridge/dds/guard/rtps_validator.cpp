#include "bridge/dds/guard/rtps_validator.hpp"

#include <algorithm>
#include <string_view>

#include "bridge/dds/guard/rtps_cursor.hpp"

namespace fieldcast {
namespace {

using Bytes = std::span<const std::uint8_t>;
using Fault = std::optional<RtpsFault>;

constexpr std::size_t kMostSubmessages = 2048;
constexpr std::uint32_t kMostBits = 256;  // of a set, RTPS 2.2, 9.4.2.6
constexpr std::int64_t kMostSequence = std::int64_t{1} << 48;
constexpr std::uint32_t kLeastFragment = 128;  // bytes
constexpr std::uint16_t kToInlineQosOfData = 16, kToInlineQosOfFragment = 28;
constexpr std::uint16_t kPlCdrBig = 0x0002, kPlCdrLittle = 0x0003;
constexpr std::uint16_t kLastEncapsulation = 0x000b;  // DDS-XTypes 1.2, 7.6.2.1.2
constexpr std::uint32_t kMostReceivers = 64;          // with a code of their own

// RTPS 2.2, 9.3.1.2; DDS Security 1.1, 7.3.7; DDS-XTypes 1.2, 7.6.3.3.
constexpr EntityBytes kTopicsWriter{0x00, 0x00, 0x02, 0xc2};
constexpr EntityBytes kLivelinessWriter{0x00, 0x02, 0x00, 0xc2};
constexpr EntityBytes kHandshakeWriter{0x00, 0x02, 0x01, 0xc3};

enum : std::uint8_t { kInlineQos = 2, kData = 4, kKey = 8, kKeyOfFragment = 4, kInvalidTime = 2 };

EntityBytes entity(RtpsCursor& in) {
  EntityBytes bytes{};
  std::ranges::copy(in.take(bytes.size()), bytes.begin());
  return bytes;
}

bool is_numbered(std::int64_t number) { return number >= 1 && number < kMostSequence; }

// A set of numbers: how many bits, then the words that hold them.
Fault check_set(RtpsCursor& in) {
  const std::uint32_t bits = in.u32();
  if (!in.good() || bits > kMostBits) return RtpsFault::kBitmap;
  in.take((bits + 31) / 32 * 4);
  return in.good() ? Fault{} : RtpsFault::kBitmap;
}

class Validator {
 public:
  Validator(Bytes datagram, const RtpsLimits& limits, RtpsEvents* events)
      : datagram_(datagram), limits_(limits), events_(events) {}

  Fault run() {
    if (datagram_.size() < kMessageHeader || datagram_[4] != 2 ||
        !std::ranges::equal(datagram_.first(4), std::string_view("RTPS")))
      return RtpsFault::kHeader;
    at_ = kMessageHeader;
    for (std::size_t n = 0; at_ < datagram_.size(); ++n) {
      if (n == kMostSubmessages) return RtpsFault::kOrder;
      if (const Fault fault = next()) return fault;
    }
    return is_open_ ? Fault{RtpsFault::kOrder} : std::nullopt;
  }

 private:
  Fault next() {
    const Bytes rest = datagram_.subspan(at_);
    if (rest.size() < kSubmessageHeader) return RtpsFault::kSubmessage;
    event_ = {};
    event_.to = to_;
    event_.kind = static_cast<Submessage>(rest[0]);
    event_.at = at_;
    event_.little = (rest[1] & kLittleEndianFlag) != 0;
    flags_ = rest[1];
    std::size_t length = event_.little ? rest[2] | rest[3] << 8 : rest[2] << 8 | rest[3];
    // 9.4.5.1.3: 0 means up to the end of the message, except for those that may be empty.
    const bool may_be_empty = event_.kind == Submessage::kPad || event_.kind == Submessage::kInfoTs;
    if (length == 0 && !may_be_empty) length = rest.size() - kSubmessageHeader;
    const std::size_t end = kSubmessageHeader + length;
    if (end > rest.size() || (length % 4 != 0 && end != rest.size())) return RtpsFault::kSubmessage;
    at_ += end;
    if (const Fault fault = check_order(end == rest.size())) return fault;
    return check(rest.subspan(kSubmessageHeader, length));
  }

  // DDS Security 1.1, 7.3.6.2: prefix, one submessage, postfix; of a whole message the first and
  // the last one.
  Fault check_order(bool is_last) {
    const Submessage kind = event_.kind;
    if (kind == Submessage::kSrtpsPrefix) {
      if (event_.at != kMessageHeader || is_last) return RtpsFault::kOrder;
      is_protected_ = true;
    } else if (kind == Submessage::kSrtpsPostfix) {
      if (!is_protected_) return RtpsFault::kOrder;
      is_protected_ = false;
      is_closed_ = true;
    } else if (is_closed_) {  // only the counts of the vendor may follow
      if (kind < Submessage::kStatistics) return RtpsFault::kOrder;
    } else if (kind == Submessage::kSecPrefix) {
      if (step_ != Step::kOutside) return RtpsFault::kOrder;
      step_ = Step::kBody;
    } else if (kind == Submessage::kSecPostfix) {
      if (step_ != Step::kPostfix) return RtpsFault::kOrder;
      step_ = Step::kOutside;
    } else if (step_ == Step::kBody) {
      step_ = Step::kPostfix;
    } else if (step_ == Step::kPostfix || (kind == Submessage::kSecBody && !is_protected_)) {
      return RtpsFault::kOrder;
    }
    // Fast DDS asserts that its counts are the last submessage (read_statistics_submessage), and
    // ends the process if they are not.
    const bool is_fast_dds = datagram_[6] == 1 && datagram_[7] == 15;
    if (kind == Submessage::kStatistics && is_fast_dds && !is_last) return RtpsFault::kOrder;
    is_open_ = is_protected_ || step_ != Step::kOutside;
    // Without DDS Security, the library reads what is between the headers as if there were none.
    event_.is_protected = is_open_ && limits_.secured;
    return std::nullopt;
  }

  Fault check(Bytes body) {
    RtpsCursor in(body, event_.little);
    switch (event_.kind) {
      case Submessage::kData: return check_data(in, body);
      case Submessage::kDataFrag: return check_fragment(in, body);
      case Submessage::kHeartbeat: return check_heartbeat(in);
      case Submessage::kGap: return check_gap(in);
      case Submessage::kAckNack: return check_acknowledgement(in);
      case Submessage::kNackFrag: return check_missing_fragments(in);
      case Submessage::kHeartbeatFrag: {
        in.take(8);
        const bool numbered = is_numbered(in.sequence_number()), begun = in.u32() >= 1;
        in.u32();
        if (!in.good()) return RtpsFault::kSubmessage;
        return numbered && begun ? Fault{} : RtpsFault::kSequenceNumber;
      }
      case Submessage::kPad: return std::nullopt;
      case Submessage::kInfoTs:
        return (flags_ & kInvalidTime) != 0 || body.size() >= 8 ? Fault{} : RtpsFault::kSubmessage;
      case Submessage::kInfoDst:
        if (body.size() < to_.size()) return RtpsFault::kSubmessage;
        std::copy_n(body.begin(), to_.size(), to_.begin());
        return std::nullopt;
      case Submessage::kInfoSource: return check_source(body);
      // They redirect responses; Fieldcast needs no DDS that uses them.
      case Submessage::kInfoReply:
      case Submessage::kInfoReplyIp4: return RtpsFault::kOrder;
      // The header of DDS Security: kind and key, session, initialization vector.
      case Submessage::kSecPrefix:
      case Submessage::kSrtpsPrefix: return body.size() == 20 ? Fault{} : RtpsFault::kSubmessage;
      case Submessage::kSecBody: return check_body(body);
      case Submessage::kSecPostfix:
      case Submessage::kSrtpsPostfix: return check_postfix(body);
      default: return std::nullopt;  // the library skips it
    }
  }

  // unused(4) version(2) vendor(2) prefix(12). It names another sender. DDS Security repeats the
  // sender after the header of a protected message (DDS Security 1.1, 8.5.1.9.4).
  Fault check_source(Bytes body) {
    const bool repeats = is_protected_ && body.size() == 20 &&
                         std::ranges::equal(body.subspan(8), datagram_.subspan(8, 12));
    return repeats ? Fault{} : RtpsFault::kOrder;
  }

  // The length is big-endian regardless of the flag (Fast DDS, AESGCMGMAC_Transform).
  static Fault check_body(Bytes body) {
    RtpsCursor in(body, false);
    const std::uint32_t length = in.u32();
    return in.good() && length <= in.left() ? Fault{} : RtpsFault::kSubmessage;
  }
  static Fault check_postfix(Bytes body) {
    RtpsCursor in(body, false);
    in.take(16);
    const std::uint32_t receivers = in.u32();
    const bool fits = in.good() && receivers <= kMostReceivers && 20 * receivers <= in.left();
    return fits ? Fault{} : RtpsFault::kSubmessage;
  }

  // reader(4) writer(4) start(8) base(8) bits(4) words..
  Fault check_gap(RtpsCursor& in) {
    event_.reader = entity(in);
    event_.writer = entity(in);
    event_.first = in.sequence_number();
    event_.base = in.sequence_number();
    if (const Fault fault = check_set(in)) return fault;
    if (!is_numbered(event_.first) || event_.base < event_.first || !is_numbered(event_.base))
      return RtpsFault::kSequenceNumber;
    return report();
  }

  // reader(4) writer(4) first(8) last(8) count(4)
  Fault check_heartbeat(RtpsCursor& in) {
    event_.reader = entity(in);
    event_.writer = entity(in);
    event_.first = in.sequence_number();
    event_.base = in.sequence_number() + 1;
    event_.count = in.u32();
    if (!in.good()) return RtpsFault::kSubmessage;
    if (event_.first < 0 || event_.first >= kMostSequence || event_.base < event_.first ||
        event_.base >= kMostSequence)
      return RtpsFault::kSequenceNumber;
    return report();
  }

  // reader(4) writer(4) base(8) bits(4) words.. count(4); base 0 acknowledges nothing yet.
  Fault check_acknowledgement(RtpsCursor& in) {
    event_.reader = entity(in);
    event_.writer = entity(in);
    event_.base = in.sequence_number();
    if (const Fault fault = check_set(in)) return fault;
    event_.count = in.u32();
    if (!in.good()) return RtpsFault::kSubmessage;
    if (event_.base < 0 || event_.base >= kMostSequence) return RtpsFault::kSequenceNumber;
    return report();
  }

  // reader(4) writer(4) number(8) base(4) bits(4) words.. count(4)
  Fault check_missing_fragments(RtpsCursor& in) {
    in.take(8);
    const std::int64_t number = in.sequence_number();
    const std::uint32_t base = in.u32();
    if (const Fault fault = check_set(in)) return fault;
    in.u32();
    if (!in.good()) return RtpsFault::kSubmessage;
    if (!is_numbered(number)) return RtpsFault::kSequenceNumber;
    return base >= 1 && base <= limits_.sample_bytes ? Fault{} : RtpsFault::kFragment;
  }

  Fault check_inline_qos(RtpsCursor& in, Bytes body) {
    const std::size_t at = in.at();
    if (const Fault fault = check_parameters(body.subspan(at), event_.little, event_.parameters))
      return fault;
    // The library must parse no content filter here, and nothing of it can be left out.
    if (!event_.parameters.hidden.empty()) return RtpsFault::kParameter;
    in.take(event_.parameters.size);
    return std::nullopt;
  }

  // extra(2) to inline QoS(2) reader(4) writer(4) number(8) inline QoS.. payload..
  Fault check_data(RtpsCursor& in, Bytes body) {
    in.u16();
    const std::uint16_t to_inline_qos = in.u16();
    event_.reader = entity(in);
    event_.writer = entity(in);
    event_.first = in.sequence_number();
    const bool has_data = (flags_ & kData) != 0, has_key = (flags_ & kKey) != 0;
    if (!in.good() || to_inline_qos != kToInlineQosOfData || (has_data && has_key))
      return RtpsFault::kSubmessage;
    if (!is_numbered(event_.first)) return RtpsFault::kSequenceNumber;
    if ((flags_ & kInlineQos) != 0) {
      if (const Fault fault = check_inline_qos(in, body)) return fault;
    }
    if (!has_data && !has_key) return is_discovery() ? report_discovery() : Fault{};
    const std::size_t payload_at = in.at();
    RtpsCursor head(body.subspan(payload_at), false);  // big-endian regardless of the flag
    const std::uint16_t encapsulation = head.u16();
    head.u16();
    if (!head.good() || encapsulation > kLastEncapsulation) return RtpsFault::kEncapsulation;
    if ((event_.writer[3] & kBuiltIn) != kBuiltIn) return std::nullopt;
    const Bytes content = body.subspan(payload_at + 4);
    const bool little = (encapsulation & 1) != 0;
    if (is_discovery()) {
      if (encapsulation != kPlCdrBig && encapsulation != kPlCdrLittle)
        return RtpsFault::kEncapsulation;
      ParameterFacts facts;
      if (const Fault fault = check_parameters(content, little, facts)) return fault;
      if (facts.key_hash.empty()) facts.key_hash = event_.parameters.key_hash;
      if (event_.parameters.status != 0) facts.status = event_.parameters.status;
      event_.parameters = std::move(facts);
      event_.parameters_at = event_.at + kSubmessageHeader + payload_at + 4;
      event_.little = little;
      return report_discovery();
    }
    if (event_.writer == kLivelinessWriter) return check_liveliness(content, little);
    if (event_.writer == kHandshakeWriter) return check_handshake(content, little);
    // The other built-in endpoints of DDS Security are protected: the library authenticates them.
    return event_.writer[0] == 0xff ? Fault{} : RtpsFault::kService;
  }

  [[nodiscard]] bool is_discovery() const {
    return event_.writer == kParticipantWriter || event_.writer == kPublicationsWriter ||
           event_.writer == kSubscriptionsWriter || event_.writer == kTopicsWriter;
  }

  // RTPS 2.2, 9.6.2.1: participant(12) kind(4) length(4) data..
  static Fault check_liveliness(Bytes content, bool little) {
    RtpsCursor in(content, little);
    in.take(16);
    const std::uint32_t length = in.u32();
    return in.good() && length <= in.left() ? Fault{} : RtpsFault::kParameter;
  }

  // DDS Security 1.1, 7.3.4: two message identities(24), three entities(16), class, holders.
  static Fault check_handshake(Bytes content, bool little) {
    RtpsCursor in(content, little);
    in.take(2 * 24 + 3 * 16);
    constexpr std::uint32_t kMostHolders = 4;
    if (!in.good() || !cdr_walk::is_text(in, cdr_walk::kLongestText)) return RtpsFault::kParameter;
    const std::uint32_t holders = in.u32();
    if (!in.good() || holders > kMostHolders) return RtpsFault::kParameter;
    for (std::uint32_t i = 0; i < holders; ++i)
      if (!cdr_walk::is_token(in)) return RtpsFault::kParameter;
    return std::nullopt;
  }

  // extra(2) to inline QoS(2) reader(4) writer(4) number(8) start(4) count(2) size(2) sample(4)
  // inline QoS.. payload..
  Fault check_fragment(RtpsCursor& in, Bytes body) {
    in.u16();
    const std::uint16_t to_inline_qos = in.u16();
    event_.reader = entity(in);
    event_.writer = entity(in);
    event_.first = in.sequence_number();
    const std::uint64_t start = in.u32(), count = in.u16(), size = in.u16();
    event_.sample_size = in.u32();
    const std::uint64_t sample = event_.sample_size;
    if (!in.good() || to_inline_qos != kToInlineQosOfFragment || (flags_ & kKeyOfFragment) != 0)
      return RtpsFault::kSubmessage;
    if (!is_numbered(event_.first)) return RtpsFault::kSequenceNumber;
    if (sample > limits_.sample_bytes) return RtpsFault::kSampleSize;
    if (size < kLeastFragment || sample < 4) return RtpsFault::kFragment;
    const std::uint64_t fragments = (sample + size - 1) / size, last = start + count - 1;
    if (start < 1 || count < 1 || last > fragments) return RtpsFault::kFragment;
    event_.buffer_size =
        static_cast<std::uint32_t>(std::max(sample, ((fragments - 1) * size + 3) / 4 * 4 + 4));
    if ((flags_ & kInlineQos) != 0) {
      if (const Fault fault = check_inline_qos(in, body)) return fault;
    }
    const std::uint64_t expected = (last == fragments ? sample : last * size) - (start - 1) * size;
    if (in.left() < expected || in.left() > expected + 3) return RtpsFault::kFragment;
    return report();
  }

  // An announcement names the sender's own entities, except where a server relays it.
  Fault report_discovery() {
    if (!limits_.relayed) {
      const Bytes sender = datagram_.subspan(8, 12);
      const ParameterFacts& facts = event_.parameters;
      for (const Bytes guid : {facts.participant_guid, facts.endpoint_guid, facts.key_hash})
        if (!guid.empty() && !std::ranges::equal(guid.first(sender.size()), sender))
          return RtpsFault::kParameter;
    }
    return report();
  }
  Fault report() { return events_ == nullptr ? std::nullopt : events_->on_event(event_); }

  enum class Step : std::uint8_t { kOutside, kBody, kPostfix };

  const Bytes datagram_;
  const RtpsLimits& limits_;
  RtpsEvents* const events_;
  std::size_t at_ = 0;
  std::uint8_t flags_ = 0;
  RtpsEvent event_;
  ParticipantPrefix to_{};
  Step step_ = Step::kOutside;
  bool is_protected_ = false;  // between the prefix and the postfix of a whole message
  bool is_closed_ = false;     // after that postfix
  bool is_open_ = false;       // a protected part has not ended yet
};

}  // namespace

std::optional<RtpsFault> fault_of(std::span<const std::uint8_t> datagram, const RtpsLimits& limits,
                                  RtpsEvents* events) {
  return Validator(datagram, limits, events).run();
}

}  // namespace fieldcast
