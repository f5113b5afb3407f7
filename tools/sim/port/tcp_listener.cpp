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

tl::expected<FileDescriptor, std::string> listen_on(const std::string& loopback,
                                                    std::uint16_t port) {
  const auto failed = [&] {
    return tl::unexpected(
        fmt::format("{}:{}: cannot listen ({})", loopback, port, errno_text(errno)));
  };
  FileDescriptor listener(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!listener) return failed();
  const int on = 1;
  ::setsockopt(listener.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  ::inet_pton(AF_INET, loopback.c_str(), &address.sin_addr);
  if (::bind(listener.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      ::listen(listener.get(), 16) != 0) {
    return failed();
  }
  return listener;
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
