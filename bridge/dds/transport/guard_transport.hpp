// A transport above another transport that changes RTPS messages:
// - It turns marked messages into unregister messages (unregister_message.hpp) when they are sent.
// - It joins messages that are sent together (joined_sending.hpp).
// - It passes each received datagram to the guard (transport/) before the library reads it, and
//   with DDS Security to an IncomingFilter.
// - With discovery servers, it notifies the library of restarted servers, and changes the number of
//   its announcements to them (participant_number.hpp).
//
// All other messages are sent unchanged.
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

// Changes the sequence number of the announcements of a participant to discovery servers.
//
// A server of Fast DDS 2.9.1 distinguishes new and old announcements by the writer's number in a
// parameter of the message. After the server has removed a participant, it compares that number
// with its own number of the removal message, until all clients have acknowledged it. A participant
// that returns in that time counts from 1, and its announcement is dropped
// (DiscoveryDataBase::update_participant_from_change_). The server keeps its endpoints without a
// participant, so they are not found until the server restarts. Here, the numbers are above all
// numbers of a server. Pure; any thread.

// Returns the message to send in place of `message`. Empty if `message` is not an announcement of
// this participant.
[[nodiscard]] std::vector<std::uint8_t> with_number_above_servers(
    std::span<const std::uint8_t> message);

}  // namespace fieldcast
