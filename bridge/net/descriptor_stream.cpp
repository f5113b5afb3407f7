#include <sys/ioctl.h>
#include <sys/socket.h>

#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>

#include "bridge/net/stream_of.hpp"

namespace fieldcast {

namespace asio = boost::asio;

// TIOCOUTQ equals SIOCOUTQ: one request code for lines and sockets.
std::size_t queued_at(int fd) {
  int count = 0;
  return ::ioctl(fd, TIOCOUTQ, &count) == 0 && count > 0 ? static_cast<std::size_t>(count) : 0;
}

std::unique_ptr<ByteStream> descriptor_stream(asio::io_context& io, FileDescriptor descriptor) {
  boost::system::error_code fault;
  int domain = 0;
  socklen_t size = sizeof domain;
  if (::getsockopt(descriptor.get(), SOL_SOCKET, SO_DOMAIN, &domain, &size) == 0) {
    // As a socket, so that a write to a closed peer returns an error and raises no signal.
    asio::generic::stream_protocol::socket socket(io);
    socket.assign(asio::generic::stream_protocol(domain, IPPROTO_TCP), descriptor.get(), fault);
    if (fault) return nullptr;
    (void)descriptor.release();
    return std::make_unique<StreamOf<decltype(socket)>>(std::move(socket));
  }
  asio::posix::stream_descriptor stream(io);
  stream.assign(descriptor.get(), fault);
  if (fault) return nullptr;
  (void)descriptor.release();
  return std::make_unique<StreamOf<decltype(stream)>>(std::move(stream));
}

}  // namespace fieldcast
