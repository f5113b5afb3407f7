// A blocking socket client for tests that sends exactly the given bytes.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

namespace fieldcast::web {

class RawClient {
 public:
  static constexpr int kPatience = 5000;  // ms, for each operation

  // `receive_buffer`: size of the kernel's buffer in bytes; 0 for its default.
  explicit RawClient(std::uint16_t port, int receive_buffer = 0)
      : fd_(::socket(AF_INET, SOCK_STREAM, 0)) {
    if (receive_buffer > 0)
      ::setsockopt(fd_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ = ::connect(fd_, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0;
  }
  ~RawClient() {
    if (fd_ >= 0) ::close(fd_);
  }
  RawClient(RawClient&& other) noexcept
      : fd_(std::exchange(other.fd_, -1)),
        connected_(other.connected_),
        received_(std::move(other.received_)) {}
  RawClient& operator=(RawClient&&) = delete;

  [[nodiscard]] bool connected() const { return connected_; }
  bool send(const std::string& bytes) {
    return ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL) ==
           static_cast<ssize_t>(bytes.size());
  }
  // Returns all bytes up to the mark, or what was received until the end or the timeout.
  std::string read_until(const std::string& mark) {
    while (received_.find(mark) == std::string::npos && more()) {}
    const std::size_t at = received_.find(mark);
    const std::size_t size = at == std::string::npos ? received_.size() : at + mark.size();
    std::string text = received_.substr(0, size);
    received_.erase(0, size);
    return text;
  }
  std::string read(std::size_t count) {
    while (received_.size() < count && more()) {}
    std::string bytes = received_.substr(0, count);
    received_.erase(0, bytes.size());
    return bytes;
  }
  // Returns whether the station closes the connection in time; reads what it sends before.
  bool ends() {
    while (more()) {}
    return ended_;
  }

  static std::string upgrade(std::uint16_t port, const std::string& more = {},
                             const std::string& origin = {}) {
    const std::string host = "127.0.0.1:" + std::to_string(port);
    return "GET /live HTTP/1.1\r\nHost: " + host +
           "\r\nOrigin: " + (origin.empty() ? "http://" + host : origin) +
           "\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
           "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: "
           "fieldcast.1\r\n" +
           more + "\r\n";
  }
  // Returns a short client frame, masked with zeros (RFC 6455, 5.2).
  static std::string frame(std::uint8_t opcode, const std::string& payload) {
    std::string bytes{static_cast<char>(0x80 | opcode)};
    if (payload.size() < 126) {
      bytes += static_cast<char>(0x80 | payload.size());
    } else {
      bytes += static_cast<char>(0x80 | 126);
      bytes += static_cast<char>(payload.size() >> 8);
      bytes += static_cast<char>(payload.size() & 255);
    }
    return bytes + std::string(4, '\0') + payload;
  }
  // Returns the first byte and the payload of the station's next frame.
  std::optional<std::pair<std::uint8_t, std::string>> next_frame() {
    const std::string head = read(2);
    if (head.size() < 2) return std::nullopt;
    std::size_t size = static_cast<std::uint8_t>(head[1]);
    const std::size_t more_bytes = size == 126 ? 2 : size == 127 ? 8 : 0;
    if (more_bytes > 0) {
      size = 0;
      for (const char c : read(more_bytes)) size = size << 8 | static_cast<std::uint8_t>(c);
    }
    return std::pair{static_cast<std::uint8_t>(head[0]), read(size)};
  }

 private:
  bool more() {
    pollfd readable{fd_, POLLIN, 0};
    if (::poll(&readable, 1, kPatience) != 1) return false;
    char bytes[65536];
    const ssize_t count = ::recv(fd_, bytes, sizeof bytes, 0);
    ended_ = count <= 0;
    if (count > 0) received_.append(bytes, static_cast<std::size_t>(count));
    return count > 0;
  }

  int fd_;
  bool connected_ = false, ended_ = false;
  std::string received_;
};

}  // namespace fieldcast::web
