#include "bridge/dds/note_transport.hpp"

#include <fastdds/rtps/network/SenderResource.h>

#include <vector>

#include "bridge/dds/unregister_note.hpp"

namespace fieldcast {

namespace {

namespace rtps = eprosima::fastrtps::rtps;
namespace transport = eprosima::fastdds::rtps;

class NoteTransport : public transport::ChainingTransport {
 public:
  explicit NoteTransport(const NoteTransportDescriptor& descriptor)
      : ChainingTransport(descriptor), descriptor_(descriptor) {}

  transport::TransportDescriptorInterface* get_configuration() override { return &descriptor_; }

  bool send(rtps::SenderResource* below, const rtps::octet* bytes, std::uint32_t size,
            transport::LocatorsIterator* begin, transport::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& deadline) override {
    if (!holds_marks({bytes, size})) return below->send(bytes, size, begin, end, deadline);
    thread_local std::vector<std::uint8_t> copy;  // at most one message of the transport
    copy.assign(bytes, bytes + size);
    turn_marks_into_notes(copy);
    return below->send(copy.data(), size, begin, end, deadline);
  }

  void receive(transport::TransportReceiverInterface* above, const rtps::octet* bytes,
               std::uint32_t size, const rtps::Locator_t& local,
               const rtps::Locator_t& remote) override {
    above->OnDataReceived(bytes, size, local, remote);
  }

 private:
  NoteTransportDescriptor descriptor_;
};

}  // namespace

transport::TransportInterface* NoteTransportDescriptor::create_transport() const {
  return new NoteTransport(*this);
}

}  // namespace fieldcast
