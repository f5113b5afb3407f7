#include "bridge/net/byte_stream.hpp"

#include <fmt/format.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <utility>

#include "bridge/net/stream_of.hpp"

namespace fieldcast {

namespace asio = boost::asio;

std::unique_ptr<ByteStream> socket_stream(asio::ip::tcp::socket socket) {
  return std::make_unique<StreamOf<asio::ip::tcp::socket>>(std::move(socket));
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
