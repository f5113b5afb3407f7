#include "bridge/port/tcp_port.hpp"

#include <fmt/format.h>

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>

#include "bridge/port/socket_stream.hpp"

namespace fieldcast {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;

// Resolves the name and connects, within the configured time.
class TcpOpening final : public PortOpening {
 public:
  TcpOpening(asio::io_context& io, const TcpPortSpec& spec, PortListener& listener)
      : PortOpening(io, listener), spec_(spec), resolver_(io), socket_(io), limit_(io) {}

  void begin() override {
    limit_.expires_after(spec_.connect_timeout);
    limit_.async_wait([self = self_as<TcpOpening>()](boost::system::error_code fault) {
      if (!self->over_ && self->stream() == nullptr && !fault)
        self->give_up("no connection within " + to_text(self->spec_.connect_timeout));
    });
    resolver_.async_resolve(
        spec_.host, std::to_string(spec_.port),
        [self = self_as<TcpOpening>()](boost::system::error_code fault,
                                       const tcp::resolver::results_type& found) {
          if (self->over_) return;
          if (!fault) return self->connect(found);
          self->give_up(fmt::format("host name '{}': {}", self->spec_.host, fault.message()));
        });
  }

 private:
  void connect(const tcp::resolver::results_type& endpoints) {
    asio::async_connect(
        socket_, endpoints,
        [self = self_as<TcpOpening>()](boost::system::error_code fault, const tcp::endpoint&) {
          if (self->over_) return;
          if (fault) return self->give_up(self->with_fence(fault.message()));
          self->connected();
        });
  }

  void connected() {
    limit_.cancel();
    boost::system::error_code fault;
    FileDescriptor socket(socket_.release(fault));
    const Clients clients = spec_.fence.is(Fence::kOneClient) ? Clients::kOne : Clients::kMany;
    auto stream = fault ? nullptr : make_socket_stream(io_, std::move(socket), listener_, clients);
    if (!stream) return give_up("the connection is closed already");
    opened(std::move(stream));
  }

  [[nodiscard]] std::string with_fence(std::string reason) const {
    if (!spec_.fence.is(Fence::kOneClient)) return reason;
    return reason + " (it accepts one client: another client may be connected)";
  }

  void give_up(std::string reason) { fail(std::move(reason), Cause::kPortUnreachable); }

  void cancel() override {
    limit_.cancel();
    resolver_.cancel();
    boost::system::error_code ignored;
    socket_.close(ignored);
  }

  TcpPortSpec spec_;
  tcp::resolver resolver_;
  tcp::socket socket_;
  asio::steady_timer limit_;
};

}  // namespace

std::shared_ptr<PortOpening> TcpPort::make_opening(PortListener& listener) {
  return std::make_shared<TcpOpening>(io_, spec_, listener);
}

}  // namespace fieldcast
