// A blocking TCP client with timeouts: for tests that simulate a module or an engineer's client.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <string>
#include <string_view>

#include "bridge/base/file_descriptor.hpp"
#include "core/base/bytes.hpp"

namespace fieldcast::test {

// Returns an unused port below the kernel's ephemeral range, so that no other connection gets it.
[[nodiscard]] inline std::uint16_t free_port() {
  constexpr unsigned kLowest = 20000, kCount = 12000, kStep = 7;
  static unsigned asked = 0;
  for (unsigned attempt = 0; attempt < kCount; ++attempt) {
    const auto port = static_cast<std::uint16_t>(
        kLowest + (static_cast<unsigned>(::getpid()) * kStep + asked++) % kCount);
    const FileDescriptor fd(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::bind(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0)
      return port;
  }
  ADD_FAILURE() << "every port from 20000 to 31999 is taken";
  return 0;
}

class TcpClient {
 public:
  // `source`: the loopback address to connect from.
  explicit TcpClient(std::uint16_t port, const char* source = "127.0.0.1")
      : fd_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    EXPECT_EQ(::inet_pton(AF_INET, source, &address.sin_addr), 1);
    EXPECT_EQ(::bind(fd_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0)
        << errno_text(errno);
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(fd_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0)
        << errno_text(errno);
  }

  void send(ByteView bytes) const {
    while (!bytes.empty()) {
      const ssize_t sent = ::send(fd_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent <= 0) return;  // the peer has closed; reading reports it
      bytes = bytes.subspan(static_cast<std::size_t>(sent));
    }
  }
  void send(std::string_view text) const {
    send({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }

  // Returns the data up to and including `end`, or what arrived until the limit or the close.
  [[nodiscard]] std::string receive(std::string_view end,
                                    std::chrono::milliseconds limit = std::chrono::seconds{10}) {
    const auto deadline = std::chrono::steady_clock::now() + limit;
    std::size_t found = received_.find(end);
    while (found == received_.npos && std::chrono::steady_clock::now() < deadline && !closed_) {
      read_some();
      found = received_.find(end);
    }
    const std::size_t count = found == received_.npos ? received_.size() : found + end.size();
    std::string out = received_.substr(0, count);
    received_.erase(0, count);
    return out;
  }
  [[nodiscard]] std::string receive_bytes(std::size_t count,
                                          std::chrono::milliseconds limit = std::chrono::seconds{
                                              10}) {
    const auto deadline = std::chrono::steady_clock::now() + limit;
    while (received_.size() < count && std::chrono::steady_clock::now() < deadline && !closed_)
      read_some();
    std::string out = received_.substr(0, count);
    received_.erase(0, out.size());
    return out;
  }
  [[nodiscard]] bool is_closed(std::chrono::milliseconds limit = std::chrono::seconds{10}) {
    const auto deadline = std::chrono::steady_clock::now() + limit;
    while (!closed_ && std::chrono::steady_clock::now() < deadline) read_some();
    return closed_;
  }
  void close() { fd_.reset(); }
  [[nodiscard]] int fd() const { return fd_.get(); }

 private:
  void read_some() {
    pollfd wait{fd_.get(), POLLIN, 0};
    if (::poll(&wait, 1, 20) <= 0) return;
    char piece[4096];
    const ssize_t count = ::recv(fd_.get(), piece, sizeof piece, MSG_DONTWAIT);
    if (count > 0) received_.append(piece, static_cast<std::size_t>(count));
    if (count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR)) closed_ = true;
  }

  FileDescriptor fd_;
  std::string received_;
  bool closed_ = false;
};

}  // namespace fieldcast::test
