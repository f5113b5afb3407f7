#include "bridge/dds/transport/guard_transport.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <vector>

#include "bridge/dds/filter/sent_message.hpp"
#include "bridge/dds/guard/parameter_list.hpp"
#include "bridge/dds/guard/rtps_message.hpp"

namespace fieldcast {

namespace {

class GuardTransport : public PassingTransport {
 public:
  explicit GuardTransport(const GuardTransportDescriptor& descriptor)
      : PassingTransport(descriptor), descriptor_(descriptor) {}

  rtps_transport::TransportDescriptorInterface* get_configuration() override {
    return &descriptor_;
  }

  bool on_message(const OutgoingMessage& message) override {
    if (descriptor_.restarts != nullptr) {
      const auto announcement = with_number_above_servers(message.bytes);
      if (!announcement.empty()) {
        OutgoingMessage raised = message;
        raised.bytes = announcement;
        return pass(raised);
      }
    }
    if (!holds_marks(message.bytes)) return pass(message);
    thread_local std::vector<std::uint8_t> copy;  // at most one message of the transport
    copy.assign(message.bytes.begin(), message.bytes.end());
    turn_marks_into_notes(copy);
    OutgoingMessage turned = message;
    turned.bytes = copy;
    return pass(turned);
  }

 protected:
  void on_received(const IncomingMessage& received) override {
    thread_local DatagramGuard::Bytes scratch;  // at most one datagram, and space after it
    DatagramGuard::Address from{};
    std::copy_n(received.remote.address, from.size(), from.begin());
    const auto verdict = descriptor_.guard->check(received.bytes, from, scratch);
    if (!verdict.before.empty()) received.deliver(verdict.before);
    if (verdict.fault) return;
    const IncomingMessage message{received.above, verdict.bytes, received.local, received.remote};
    if (ServerRestarts* restarts = descriptor_.restarts.get()) {
      const Instant now{std::chrono::steady_clock::now().time_since_epoch()};
      const ServerRestarts::Bytes goodbye = restarts->goodbye_before(message.bytes, now);
      if (!goodbye.empty()) message.deliver(goodbye);
    }
    IncomingFilter* filter = descriptor_.filter.get();
    if (filter == nullptr) return message.deliver(message.bytes);
    for (const IncomingFilter::Bytes& bytes : filter->goodbyes()) message.deliver(bytes);
    if (filter->takes(message.bytes)) return message.deliver(message.bytes);
    const IncomingFilter::Bytes goodbye = filter->goodbye_of_sender(message.bytes);
    if (!goodbye.empty()) message.deliver(goodbye);
  }

 private:
  bool pass(const OutgoingMessage& message) {
    if (JoinedSending* joined = JoinedSending::of_this_thread())
      return joined->send(*this, message);
    return send_whole(message);
  }

  GuardTransportDescriptor descriptor_;
};

}  // namespace

rtps_transport::TransportInterface* GuardTransportDescriptor::create_transport() const {
  return new GuardTransport(*this);
}

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

// Offset of the number; 0 if it is not an announcement by `prefix` in the library's byte order.
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
