#include "bridge/port/stream_port.hpp"

namespace fieldcast {

void PortOpening::close() {
  if (std::exchange(over_, true)) return;
  cancel();
  if (stream_) stream_->close();
}

void PortOpening::opened(std::shared_ptr<Stream> stream) {
  stream_ = std::move(stream);
  stream_->start();
  listener_.on_opened();
}

void PortOpening::fail(std::string reason, Cause cause) {
  close();
  listener_.on_closed(std::move(reason), cause);
}

void StreamPort::open(PortListener& listener) {
  close();
  opening_ = make_opening(listener);
  opening_->begin();
}

void StreamPort::write(ByteView bytes) {
  if (Stream* line = stream()) line->write(bytes);
}

// The network delivers responses in one piece or at its own rate.
void StreamPort::expect(std::uint32_t) {}

void StreamPort::poll() {
  if (Stream* line = stream()) line->poll();
}

FileDescriptor StreamPort::lease() {
  Stream* line = stream();
  return line ? line->lease() : FileDescriptor{};
}

void StreamPort::end_lease() {
  if (Stream* line = stream()) line->end_lease();
}

void StreamPort::close() {
  if (opening_) opening_->close();
  opening_.reset();
}

}  // namespace fieldcast
