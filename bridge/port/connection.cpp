#include "bridge/port/connection.hpp"

#include <fcntl.h>
#include <netinet/tcp.h>

#include <array>
#include <boost/asio/post.hpp>
#include <cerrno>
#include <cstring>

#include "bridge/bus/clock.hpp"

namespace fieldcast {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;

constexpr int kKeepAliveIdleSeconds = 10, kKeepAliveIntervalSeconds = 3, kKeepAliveProbes = 3;

void set_option(int fd, int level, int option, int value) {
  ::setsockopt(fd, level, option, &value, sizeof value);
}

}  // namespace

void tune_socket(int fd, Duration unacknowledged) {
  set_option(fd, IPPROTO_TCP, TCP_NODELAY, 1);
  set_option(fd, SOL_SOCKET, SO_KEEPALIVE, 1);
  set_option(fd, IPPROTO_TCP, TCP_KEEPIDLE, kKeepAliveIdleSeconds);
  set_option(fd, IPPROTO_TCP, TCP_KEEPINTVL, kKeepAliveIntervalSeconds);
  set_option(fd, IPPROTO_TCP, TCP_KEEPCNT, kKeepAliveProbes);
  const auto limit = std::chrono::duration_cast<std::chrono::milliseconds>(unacknowledged);
  set_option(fd, IPPROTO_TCP, TCP_USER_TIMEOUT, static_cast<int>(limit.count()));
}

std::optional<tcp::socket> adopt_socket(asio::io_context& io, FileDescriptor fd) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  if (::getsockname(fd.get(), reinterpret_cast<sockaddr*>(&address), &size) != 0)
    return std::nullopt;
  tcp::socket socket(io);
  boost::system::error_code fault;
  socket.assign(address.ss_family == AF_INET6 ? tcp::v6() : tcp::v4(), fd.get(), fault);
  if (fault) return std::nullopt;
  (void)fd.release();
  return socket;
}

bool peer_answers(int fd) {
  tcp_info info{};
  socklen_t size = sizeof info;
  if (::getsockopt(fd, IPPROTO_TCP, TCP_INFO, &info, &size) != 0) return true;
  const bool unanswered = info.tcpi_unacked > 0 && info.tcpi_retransmits > 0 &&
                          std::chrono::milliseconds{info.tcpi_last_ack_recv} >= kUnacknowledged;
  return !unanswered && info.tcpi_probes < kKeepAliveProbes;
}

bool Connection::start() {
  boost::system::error_code fault;
  socket_.non_blocking(true, fault);
  if (fault) return false;
  tune_socket(socket_.native_handle());
  listen();
  return true;
}

void Connection::write(ByteView bytes) {
  if (over_ || lent_) return;
  drop_stale();
  push(bytes);
}

void Connection::poll() {
  if (!over_ && !lent_) (void)take();
}

void Connection::close() {
  if (std::exchange(over_, true)) return;
  boost::system::error_code ignored;
  socket_.close(ignored);
}

FileDescriptor Connection::release() {
  if (lent_ || std::exchange(over_, true)) return {};
  boost::system::error_code fault;
  const int fd = socket_.release(fault);
  return fault ? FileDescriptor{} : FileDescriptor(fd);
}

FileDescriptor Connection::lend() {
  if (over_) return {};
  lent_ = true;
  return FileDescriptor(::fcntl(socket_.native_handle(), F_DUPFD_CLOEXEC, 0));
}

void Connection::take_back() {
  if (over_ || !std::exchange(lent_, false)) return;
  tune_socket(socket_.native_handle());  // the session had its own patience
  drop_stale();
  listen();
}

void Connection::push(ByteView bytes) {
  switch (unsent_.write(socket_.native_handle(), bytes)) {
    case Unsent::Outcome::kAllSent: return;
    case Unsent::Outcome::kBlocked: return wait_for_room();
    case Unsent::Outcome::kFailed: return fail_later(std::strerror(errno));
    case Unsent::Outcome::kFull: return fail_later("the peer takes no bytes");
  }
}

// Waits for bytes and then takes them, in two steps: nothing is taken that is not delivered at
// once, so that poll() may come between.
void Connection::listen() {
  if (over_ || lent_ || std::exchange(listening_, true)) return;
  socket_.async_wait(tcp::socket::wait_read,
                     [self = shared_from_this()](boost::system::error_code fault) {
                       self->listening_ = false;
                       if (self->over_ || self->lent_) return;
                       if (fault) return self->fail(fault.message());
                       if (self->take()) self->listen();
                     });
}

// False: the peer is gone, and that was told.
bool Connection::take() {
  const ssize_t size =
      ::recv(socket_.native_handle(), buffer_.data(), buffer_.size(), MSG_DONTWAIT);
  if (size > 0) {
    listener_.on_received({buffer_.data(), static_cast<std::size_t>(size)}, steady_now());
  } else if (size == 0 || (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR)) {
    fail(size == 0 ? "closed by the peer" : std::strerror(errno));
    return false;
  }
  return true;
}

void Connection::drop_stale() {
  std::array<std::uint8_t, 512> stale;
  while (::recv(socket_.native_handle(), stale.data(), stale.size(), MSG_DONTWAIT) ==
         static_cast<ssize_t>(stale.size())) {}
}

void Connection::wait_for_room() {
  socket_.async_wait(tcp::socket::wait_write,
                     [self = shared_from_this()](boost::system::error_code fault) {
                       if (!self->over_ && !fault) self->push({});
                     });
}

void Connection::fail_later(std::string reason) {
  asio::post(socket_.get_executor(),
             [self = shared_from_this(), reason = std::move(reason)]() mutable {
               if (!self->over_) self->fail(std::move(reason));
             });
}

void Connection::fail(std::string reason) {
  if (over_) return;
  close();
  listener_.on_closed(std::move(reason), Cause::kPortClosed);
}

}  // namespace fieldcast
