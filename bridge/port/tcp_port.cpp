#include "bridge/port/tcp_port.hpp"

#include <fmt/format.h>
#include <netinet/tcp.h>

#include <array>
#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cerrno>
#include <cstring>

#include "bridge/clock.hpp"
#include "bridge/port/unsent.hpp"

namespace fieldcast {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;

// A peer that vanished without a word is noticed within about 20 s even when nothing is sent.
constexpr int kKeepAliveIdleSeconds = 10, kKeepAliveIntervalSeconds = 3, kKeepAliveProbes = 3;
constexpr int kUnacknowledgedMilliseconds = 10'000;

void set_option(int fd, int level, int option, int value) { ::setsockopt(fd, level, option, &value, sizeof value); }

void tune(int fd) {
  set_option(fd, IPPROTO_TCP, TCP_NODELAY, 1);
  set_option(fd, SOL_SOCKET, SO_KEEPALIVE, 1);
  set_option(fd, IPPROTO_TCP, TCP_KEEPIDLE, kKeepAliveIdleSeconds);
  set_option(fd, IPPROTO_TCP, TCP_KEEPINTVL, kKeepAliveIntervalSeconds);
  set_option(fd, IPPROTO_TCP, TCP_KEEPCNT, kKeepAliveProbes);
  set_option(fd, IPPROTO_TCP, TCP_USER_TIMEOUT, kUnacknowledgedMilliseconds);
}

}  // namespace

// One connection, from open() to its end. Handlers hold it; once over_ is set they do nothing.
class TcpPort::Session : public std::enable_shared_from_this<Session> {
 public:
  Session(asio::io_context& io, const TcpPortSpec& spec, PortListener& listener)
      : spec_(spec), listener_(listener), resolver_(io), socket_(io), limit_(io) {}

  void open() {
    limit_.expires_after(spec_.connect_timeout);
    limit_.async_wait([self = shared_from_this()](boost::system::error_code fault) {
      if (!self->over_ && !fault) self->fail("no connection within " + to_text(self->spec_.connect_timeout));
    });
    resolver_.async_resolve(
        spec_.host, std::to_string(spec_.port),
        [self = shared_from_this()](boost::system::error_code fault, const tcp::resolver::results_type& found) {
          if (self->over_) return;
          if (fault) return self->fail(fmt::format("host name '{}': {}", self->spec_.host, fault.message()));
          self->connect(found);
        });
  }

  void write(ByteView bytes) {
    if (over_ || !connected_) return;
    drop_stale();
    push(bytes);
  }

  void poll() {
    if (!over_ && connected_) take();
  }

  void close() {
    if (std::exchange(over_, true)) return;
    limit_.cancel();
    resolver_.cancel();
    boost::system::error_code ignored;
    socket_.close(ignored);
  }

 private:
  void push(ByteView bytes) {
    switch (unsent_.write(socket_.native_handle(), bytes)) {
      case Unsent::Outcome::kAllSent: return;
      case Unsent::Outcome::kBlocked: return wait_for_room();
      case Unsent::Outcome::kFailed: return fail_later(std::strerror(errno));
      case Unsent::Outcome::kFull: return fail_later("the peer takes no bytes");
    }
  }

  void connect(const tcp::resolver::results_type& endpoints) {
    asio::async_connect(socket_, endpoints, [self = shared_from_this()](boost::system::error_code fault, const tcp::endpoint&) {
      if (self->over_) return;
      if (fault) return self->fail(fault.message());
      self->limit_.cancel();
      self->socket_.non_blocking(true, fault);
      if (fault) return self->fail(fault.message());
      tune(self->socket_.native_handle());
      self->connected_ = true;
      self->listener_.on_opened();
      self->listen();
    });
  }

  // Waits for bytes and then takes them, in two steps: nothing is taken that is not delivered at once, so that poll() may come
  // between.
  void listen() {
    if (over_) return;
    socket_.async_wait(tcp::socket::wait_read, [self = shared_from_this()](boost::system::error_code fault) {
      if (self->over_) return;
      if (fault) return self->fail(fault.message());
      if (self->take()) self->listen();
    });
  }

  // False: the peer is gone, and that was told.
  bool take() {
    const ssize_t size = ::recv(socket_.native_handle(), buffer_.data(), buffer_.size(), MSG_DONTWAIT);
    if (size > 0) {
      listener_.on_received({buffer_.data(), static_cast<std::size_t>(size)}, steady_now());
    } else if (size == 0 || (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR)) {
      fail(size == 0 ? "closed by the peer" : std::strerror(errno));
      return false;
    }
    return true;
  }

  void drop_stale() {
    std::array<std::uint8_t, 512> stale;
    while (::recv(socket_.native_handle(), stale.data(), stale.size(), MSG_DONTWAIT) == static_cast<ssize_t>(stale.size())) {}
  }

  void wait_for_room() {
    socket_.async_wait(tcp::socket::wait_write, [self = shared_from_this()](boost::system::error_code fault) {
      if (!self->over_ && !fault) self->push({});
    });
  }

  void fail_later(std::string reason) {
    asio::post(socket_.get_executor(), [self = shared_from_this(), reason = std::move(reason)]() mutable {
      if (!self->over_) self->fail(std::move(reason));
    });
  }

  void fail(std::string reason) {
    close();
    listener_.on_closed(std::move(reason));
  }

  TcpPortSpec spec_;
  PortListener& listener_;
  tcp::resolver resolver_;
  tcp::socket socket_;
  asio::steady_timer limit_;  // of the connecting
  Unsent unsent_{Unsent::Kind::kSocket};
  bool connected_ = false;
  bool over_ = false;
  std::array<std::uint8_t, 4096> buffer_;
};

TcpPort::TcpPort(asio::io_context& io, TcpPortSpec spec) : io_(io), spec_(std::move(spec)) {}
TcpPort::~TcpPort() { close(); }

void TcpPort::open(PortListener& listener) {
  close();
  session_ = std::make_shared<Session>(io_, spec_, listener);
  session_->open();
}

void TcpPort::write(ByteView bytes) {
  if (session_) session_->write(bytes);
}

void TcpPort::poll() {
  if (session_) session_->poll();
}

void TcpPort::close() {
  if (session_) session_->close();
  session_.reset();
}

}  // namespace fieldcast
