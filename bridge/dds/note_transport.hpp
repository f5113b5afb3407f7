// A transport over another one that turns marked messages into notes of unregistered instances
// (unregister_note.hpp) as they leave, and joins what belongs together (joined_sending.hpp).
// Everything else goes through as it is.
#pragma once

#include "bridge/dds/fastdds.hpp"

namespace fieldcast {

struct NoteTransportDescriptor : rtps_transport::ChainingTransportDescriptor {
  using ChainingTransportDescriptor::ChainingTransportDescriptor;
  // The library's; the caller owns it.
  [[nodiscard]] rtps_transport::TransportInterface* create_transport() const override;
};

}  // namespace fieldcast
