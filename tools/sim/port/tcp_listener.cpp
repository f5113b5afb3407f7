#include "tools/sim/port/tcp_listener.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <cerrno>

#include "bridge/base/file_descriptor.hpp"

namespace fieldcast::sim {

std::string loopback_for(const std::string& host) {
  in_addr address{};
  const bool loopback =
      ::inet_pton(AF_INET, host.c_str(), &address) == 1 && (ntohl(address.s_addr) >> 24) == 127;
  return loopback ? host : "127.0.0.1";
}

namespace {

// Bound to the address, which is on the loopback.
tl::expected<FileDescriptor, std::string> bound_socket(int type, const std::string& loopback,
                                                       std::uint16_t port) {
  FileDescriptor socket(::socket(AF_INET, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const int on = 1;
  if (socket && type == SOCK_STREAM)
    ::setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  ::inet_pton(AF_INET, loopback.c_str(), &address.sin_addr);
  if (socket &&
      ::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
      (type != SOCK_STREAM || ::listen(socket.get(), 16) == 0))
    return socket;
  return tl::unexpected(
      fmt::format("{}:{}: cannot listen ({})", loopback, port, errno_text(errno)));
}

}  // namespace

tl::expected<FileDescriptor, std::string> listen_on(const std::string& loopback,
                                                    std::uint16_t port) {
  return bound_socket(SOCK_STREAM, loopback, port);
}

tl::expected<FileDescriptor, std::string> receive_datagrams_on(const std::string& loopback,
                                                               std::uint16_t port) {
  return bound_socket(SOCK_DGRAM, loopback, port);
}

FileDescriptor accept_from(int listener) {
  FileDescriptor connection(::accept4(listener, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (connection) {
    const int on = 1;
    ::setsockopt(connection.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  }
  return connection;
}

}  // namespace fieldcast::sim
