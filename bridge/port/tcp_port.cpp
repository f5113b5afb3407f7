#include "bridge/port/tcp_port.hpp"

#include <fmt/format.h>

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>

#include "bridge/port/connection.hpp"

namespace fieldcast {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;

}  // namespace

// One call, from open() to its end. Handlers hold it; once over_ is set they do nothing.
class TcpPort::Session : public std::enable_shared_from_this<Session> {
 public:
  Session(asio::io_context& io, const TcpPortSpec& spec, PortListener& listener)
      : spec_(spec), listener_(listener), resolver_(io), socket_(io), limit_(io) {}

  void open() {
    limit_.expires_after(spec_.connect_timeout);
    limit_.async_wait([self = shared_from_this()](boost::system::error_code fault) {
      if (!self->over_ && !self->connection_ && !fault)
        self->fail("no connection within " + to_text(self->spec_.connect_timeout));
    });
    resolver_.async_resolve(
        spec_.host, std::to_string(spec_.port),
        [self = shared_from_this()](boost::system::error_code fault,
                                    const tcp::resolver::results_type& found) {
          if (self->over_) return;
          if (fault)
            return self->fail(fmt::format("host name '{}': {}", self->spec_.host, fault.message()));
          self->connect(found);
        });
  }

  // Null until connected.
  [[nodiscard]] Connection* connection() { return connection_.get(); }

  void close() {
    if (std::exchange(over_, true)) return;
    limit_.cancel();
    resolver_.cancel();
    boost::system::error_code ignored;
    socket_.close(ignored);
    if (connection_) connection_->close();
  }

 private:
  void connect(const tcp::resolver::results_type& endpoints) {
    asio::async_connect(
        socket_, endpoints,
        [self = shared_from_this()](boost::system::error_code fault, const tcp::endpoint&) {
          if (self->over_) return;
          if (fault) return self->fail(fault.message());
          self->limit_.cancel();
          self->connection_ =
              std::make_shared<Connection>(std::move(self->socket_), self->listener_);
          if (!self->connection_->start()) return self->fail("the connection is gone already");
          self->listener_.on_opened();
        });
  }

  void fail(std::string reason) {
    close();
    listener_.on_closed(std::move(reason), Cause::kPortUnreachable);
  }

  TcpPortSpec spec_;
  PortListener& listener_;
  tcp::resolver resolver_;
  tcp::socket socket_;
  asio::steady_timer limit_;  // of the connecting
  std::shared_ptr<Connection> connection_;
  bool over_ = false;
};

TcpPort::TcpPort(asio::io_context& io, TcpPortSpec spec) : io_(io), spec_(std::move(spec)) {}
TcpPort::~TcpPort() { close(); }

void TcpPort::open(PortListener& listener) {
  close();
  session_ = std::make_shared<Session>(io_, spec_, listener);
  session_->open();
}

void TcpPort::write(ByteView bytes) {
  if (Connection* connection = connected()) connection->write(bytes);
}

void TcpPort::poll() {
  if (Connection* connection = connected()) connection->poll();
}

FileDescriptor TcpPort::lend() {
  Connection* connection = connected();
  return connection ? connection->lend() : FileDescriptor{};
}

void TcpPort::take_back() {
  if (Connection* connection = connected()) connection->take_back();
}

Connection* TcpPort::connected() { return session_ ? session_->connection() : nullptr; }

void TcpPort::close() {
  if (session_) session_->close();
  session_.reset();
}

}  // namespace fieldcast
