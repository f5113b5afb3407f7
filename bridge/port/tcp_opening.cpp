#include "bridge/port/tcp_opening.hpp"

#include <fmt/format.h>

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>

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
      self->give_up("no connection within " + to_text(self->target_.timeout));
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
        self->connected_ = true;
        self->limit_.cancel();
        FileDescriptor socket(self->socket_.release(fault));
        if (fault) return self->give_up("the connection is closed already");
        self->connected(std::move(socket));
      });
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
