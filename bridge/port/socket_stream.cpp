#include "bridge/port/socket_stream.hpp"

#include <fcntl.h>
#include <netinet/tcp.h>

#include <cerrno>

#include "bridge/base/errno_text.hpp"

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

std::optional<Stream::End> SocketStream::restore(int fd) {
  // The programming session had set its own timeout.
  tune_socket(fd, clients_ == Clients::kOne ? kUnacknowledgedByOne : kUnacknowledged);
  return std::nullopt;
}

Stream::End SocketStream::end_of(int error) const {
  const bool closed = error == 0 || error == ECONNRESET;
  if (clients_ == Clients::kOne && closed && steady_now() - began_ < kAtOnce) {
    return {
        "closed by the server immediately: it accepts one client, and another client is connected",
        Cause::kPortInUse};
  }
  return {error == 0 ? std::string("closed by the peer") : errno_text(error)};
}

std::shared_ptr<SocketStream> make_socket_stream(asio::io_context& io, FileDescriptor socket,
                                                 PortListener& listener, Clients clients) {
  const int fd = socket.get();
  const int flags = ::fcntl(fd, F_GETFL);
  if (flags < 0 || ::fcntl(fd, F_SETFL, flags | O_NONBLOCK) != 0) return nullptr;
  tune_socket(fd, clients == Clients::kOne ? kUnacknowledgedByOne : kUnacknowledged);
  auto stream = std::make_shared<SocketStream>(io, listener, clients);
  return stream->assign(std::move(socket)) ? stream : nullptr;
}

}  // namespace fieldcast
