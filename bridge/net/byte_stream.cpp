#include "bridge/net/byte_stream.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <utility>

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

using boost::asio::ip::tcp;

namespace {

// Wait if the system has no free descriptor.
constexpr std::chrono::milliseconds kPause{100};

}  // namespace

struct Listener::State : std::enable_shared_from_this<State> {
  State(boost::asio::io_context& io, std::function<void(tcp::socket)> given)
      : acceptor(io), pause(io), come(std::move(given)) {}

  void accept() {
    acceptor.async_accept(
        [self = shared_from_this()](boost::system::error_code fault, tcp::socket socket) {
          if (self->closed) return;
          if (!fault) {
            self->come(std::move(socket));
            return self->closed ? void() : self->accept();
          }
          self->pause.expires_after(kPause);
          self->pause.async_wait([self](boost::system::error_code cancelled) {
            if (!cancelled && !self->closed) self->accept();
          });
        });
  }

  tcp::acceptor acceptor;
  boost::asio::steady_timer pause;
  std::function<void(tcp::socket)> come;
  bool closed = false;
};

Listener::Listener(boost::asio::io_context& io, std::function<void(tcp::socket)> come)
    : state_(std::make_shared<State>(io, std::move(come))) {}

Listener::~Listener() { close(); }

tl::expected<void, std::string> Listener::open(const ListenSpec& spec) {
  tcp::acceptor& acceptor = state_->acceptor;
  boost::system::error_code fault;
  const tcp::endpoint endpoint(boost::asio::ip::make_address(spec.host, fault), spec.port);
  if (!fault) acceptor.open(endpoint.protocol(), fault);
  if (!fault) acceptor.set_option(tcp::acceptor::reuse_address(true), fault);
  if (!fault) acceptor.bind(endpoint, fault);
  if (!fault) acceptor.listen(boost::asio::socket_base::max_listen_connections, fault);
  if (fault)
    return tl::make_unexpected(
        fmt::format("cannot listen at {}:{}: {}", spec.host, spec.port, fault.message()));
  state_->accept();
  return {};
}

std::uint16_t Listener::port() const { return state_->acceptor.local_endpoint().port(); }

void Listener::close() {
  state_->closed = true;
  boost::system::error_code ignored;
  state_->acceptor.close(ignored);
  state_->pause.cancel();
}

std::string address_of(const tcp::socket& socket) {
  boost::system::error_code fault;
  const auto peer = socket.remote_endpoint(fault);
  if (fault) return "?";
  const std::string address = peer.address().to_string();
  return fmt::format("{}:{}", peer.address().is_v6() ? '[' + address + ']' : address, peer.port());
}

}  // namespace fieldcast
