#include "bridge/dds/note_transport.hpp"

#include <vector>

#include "bridge/dds/unregister_note.hpp"

namespace fieldcast {

namespace {

class NoteTransport : public OutgoingTransport {
 public:
  explicit NoteTransport(const NoteTransportDescriptor& descriptor)
      : OutgoingTransport(descriptor), descriptor_(descriptor) {}

  rtps_transport::TransportDescriptorInterface* get_configuration() override {
    return &descriptor_;
  }

  std::span<const std::uint8_t> replace(std::span<const std::uint8_t> message) override {
    if (!holds_marks(message)) return message;
    thread_local std::vector<std::uint8_t> copy;  // at most one message of the transport
    copy.assign(message.begin(), message.end());
    turn_marks_into_notes(copy);
    return copy;
  }

 private:
  NoteTransportDescriptor descriptor_;
};

}  // namespace

rtps_transport::TransportInterface* NoteTransportDescriptor::create_transport() const {
  return new NoteTransport(*this);
}

}  // namespace fieldcast
