#include "bridge/net/byte_stream.hpp"

#include <sys/ioctl.h>
#include <sys/socket.h>

#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>

namespace fieldcast {
namespace {

namespace asio = boost::asio;

template <typename Stream>
class StreamOf final : public ByteStream {
 public:
  explicit StreamOf(Stream stream) : stream_(std::move(stream)) {}
  void read_some(asio::mutable_buffer into, Done done) override {
    stream_.async_read_some(into, std::move(done));
  }
  void write_some(asio::const_buffer from, Done done) override {
    stream_.async_write_some(from, std::move(done));
  }
  std::size_t queued() const override {
    return queued_at(const_cast<Stream&>(stream_).native_handle());
  }
  void end_sending() override {
    if constexpr (requires { stream_.shutdown(asio::socket_base::shutdown_send); }) {
      boost::system::error_code ignored;
      stream_.shutdown(asio::socket_base::shutdown_send, ignored);
    }
  }
  void close() override {
    boost::system::error_code ignored;
    stream_.close(ignored);
  }

 private:
  Stream stream_;
};

}  // namespace

// TIOCOUTQ equals SIOCOUTQ: one request code for lines and sockets.
std::size_t queued_at(int fd) {
  int count = 0;
  return ::ioctl(fd, TIOCOUTQ, &count) == 0 && count > 0 ? static_cast<std::size_t>(count) : 0;
}

std::unique_ptr<ByteStream> socket_stream(asio::ip::tcp::socket socket) {
  return std::make_unique<StreamOf<asio::ip::tcp::socket>>(std::move(socket));
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
