// A transport over another one that turns marked messages into notes of unregistered instances
// (unregister_note.hpp) as they leave. Everything else goes through as it is.
#pragma once

#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>

namespace fieldcast {

struct NoteTransportDescriptor : eprosima::fastdds::rtps::ChainingTransportDescriptor {
  using ChainingTransportDescriptor::ChainingTransportDescriptor;
  // The library's; the caller owns it.
  [[nodiscard]] eprosima::fastdds::rtps::TransportInterface* create_transport() const override;
};

}  // namespace fieldcast
