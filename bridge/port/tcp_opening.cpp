#include "bridge/port/tcp_opening.hpp"

#include <fmt/format.h>

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/write.hpp>

namespace fieldcast {

namespace asio = boost::asio;
using asio::ip::tcp;

TcpOpening::TcpOpening(asio::io_context& io, PortListener& listener, Target target)
    : PortOpening(io, listener),
      target_(std::move(target)),
      resolver_(io),
      socket_(io),
      limit_(io) {}

void TcpOpening::begin() {
  limit_.expires_after(target_.timeout);
  limit_.async_wait([self = self_as<TcpOpening>()](boost::system::error_code fault) {
    if (!self->over_ && !self->connected_ && !fault)
      self->give_up((self->tls_ ? "no TLS handshake within " : "no connection within ") +
                    to_text(self->target_.timeout));
  });
  resolver_.async_resolve(
      target_.host, std::to_string(target_.port),
      [self = self_as<TcpOpening>()](boost::system::error_code fault,
                                     const tcp::resolver::results_type& found) {
        if (self->over_) return;
        if (!fault) return self->connect(found);
        self->give_up(fmt::format("host name '{}': {}", self->target_.host, fault.message()));
      });
}

void TcpOpening::connect(const tcp::resolver::results_type& endpoints) {
  asio::async_connect(
      socket_, endpoints,
      [self = self_as<TcpOpening>()](boost::system::error_code fault, const tcp::endpoint&) {
        if (self->over_) return;
        if (fault) return self->give_up(self->with_fence(fault.message()));
        self->target_.tls ? self->start_tls() : self->finish();
      });
}

void TcpOpening::start_tls() {
  auto tls = TlsEngine::make(*target_.tls, target_.certified_name);
  if (!tls) return give_up("TLS: " + tls.error());
  tls_ = std::move(*tls);
  shake_hands({});
}

void TcpOpening::shake_hands(ByteView received) {
  Bytes none;
  sending_.clear();
  const bool open = tls_->receive(received, none, sending_);
  if (sending_.empty()) return shaken(open);
  asio::async_write(socket_, asio::buffer(sending_),
                    [self = self_as<TcpOpening>(), open](boost::system::error_code fault, auto) {
                      if (self->over_) return;
                      if (fault && open) return self->give_up("TLS: " + fault.message());
                      self->shaken(open);
                    });
}

// What was to be sent is sent.
void TcpOpening::shaken(bool open) {
  if (!open) return give_up(tls_->fault());
  if (tls_->ready()) return finish();
  socket_.async_read_some(
      asio::buffer(received_),
      [self = self_as<TcpOpening>()](boost::system::error_code fault, std::size_t size) {
        if (self->over_) return;
        if (!fault) return self->shake_hands(ByteView(self->received_).first(size));
        self->give_up(fault == asio::error::eof
                          ? "TLS: the server closed the connection during the handshake"
                          : "TLS: " + fault.message());
      });
}

void TcpOpening::finish() {
  connected_ = true;
  limit_.cancel();
  boost::system::error_code fault;
  FileDescriptor socket(socket_.release(fault));
  if (fault) return give_up("the connection is closed already");
  connected(std::move(socket), std::move(tls_));
}

std::string TcpOpening::with_fence(std::string reason) const {
  if (!target_.one_client) return reason;
  return reason + " (it accepts one client: another client may be connected)";
}

void TcpOpening::cancel() {
  limit_.cancel();
  resolver_.cancel();
  boost::system::error_code ignored;
  socket_.close(ignored);
}

}  // namespace fieldcast
