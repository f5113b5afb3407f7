// A transport over another one that turns marked messages into notes of unregistered instances
// (unregister_note.hpp) as they leave, and joins what belongs together (joined_sending.hpp).
// Everything else is sent unchanged. Each received datagram passes the guard (transport/) before
// the library reads it, and with DDS Security an IncomingFilter;
// with discovery servers, the library is told of those that started anew, and what it announces to
// them gets another number (participant_number.hpp).
#pragma once

#include <memory>

#include "bridge/dds/fastdds.hpp"
#include "bridge/dds/incoming_filter.hpp"
#include "bridge/dds/server_restarts.hpp"
#include "bridge/dds/transport/shared_guard.hpp"

namespace fieldcast {

struct NoteTransportDescriptor : rtps_transport::ChainingTransportDescriptor {
  // `what_is_taken`: null without DDS Security. `of_servers`: null without discovery servers.
  NoteTransportDescriptor(std::shared_ptr<rtps_transport::TransportDescriptorInterface> below,
                          std::shared_ptr<SharedGuard> of_datagrams,
                          std::shared_ptr<IncomingFilter> what_is_taken,
                          std::shared_ptr<ServerRestarts> of_servers)
      : ChainingTransportDescriptor(std::move(below)),
        guard(std::move(of_datagrams)),
        filter(std::move(what_is_taken)),
        restarts(std::move(of_servers)) {}
  // The library's; the caller owns it.
  [[nodiscard]] rtps_transport::TransportInterface* create_transport() const override;

  std::shared_ptr<SharedGuard> guard;
  std::shared_ptr<IncomingFilter> filter;
  std::shared_ptr<ServerRestarts> restarts;
};

}  // namespace fieldcast
