#include "bridge/dds/transport/guard_transport.hpp"

#include <algorithm>
#include <chrono>
#include <vector>

#include "bridge/dds/filter/joined_sending.hpp"
#include "bridge/dds/filter/unregister_message.hpp"
#include "bridge/dds/transport/participant_number.hpp"

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

}  // namespace fieldcast
