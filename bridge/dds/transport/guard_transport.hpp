// A transport above another transport that changes RTPS messages: turns marked ones into unregister
// messages, joins those sent together (sent_message.hpp), passes each received datagram to the
// guard and the IncomingFilter, and, with discovery servers, reports restarted ones and changes the
// number of its announcements. All other messages are sent unchanged.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "bridge/dds/filter/incoming_filter.hpp"
#include "bridge/dds/guard/datagram_guard.hpp"
#include "bridge/dds/library/fastdds.hpp"
#include "bridge/dds/transport/server_restarts.hpp"

namespace fieldcast {

struct GuardTransportDescriptor : rtps_transport::ChainingTransportDescriptor {
  // `what_is_taken` is null without DDS Security, `of_servers` without discovery servers.
  GuardTransportDescriptor(std::shared_ptr<rtps_transport::TransportDescriptorInterface> below,
                           std::shared_ptr<SharedGuard> of_datagrams,
                           std::shared_ptr<IncomingFilter> what_is_taken,
                           std::shared_ptr<ServerRestarts> of_servers)
      : ChainingTransportDescriptor(std::move(below)),
        guard(std::move(of_datagrams)),
        filter(std::move(what_is_taken)),
        restarts(std::move(of_servers)) {}
  // The caller (the library) owns the result.
  [[nodiscard]] rtps_transport::TransportInterface* create_transport() const override;

  std::shared_ptr<SharedGuard> guard;
  std::shared_ptr<IncomingFilter> filter;
  std::shared_ptr<ServerRestarts> restarts;
};

// Changes the sequence number of a participant's announcements to discovery servers. A server of
// Fast DDS 2.9.1 that has removed a participant compares the number of its next announcement with
// that of its own removal message, until all clients have acknowledged it. A participant that
// returns meanwhile counts from 1, so its announcement is dropped (update_participant_from_change_)
// and its endpoints are not found until the server restarts. Here, the numbers are above all
// numbers of a server. Pure; any thread.

// The message to send in its place; empty if it is not an announcement of this participant.
[[nodiscard]] std::vector<std::uint8_t> with_number_above_servers(
    std::span<const std::uint8_t> message);

}  // namespace fieldcast
