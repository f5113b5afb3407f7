#pragma once

#include <poll.h>
#include <sys/socket.h>

#include <atomic>
#include <thread>

#include "tests/bridge/support/tcp_client.hpp"

namespace fieldcast::test {

class ModuleDevice {
 public:
  explicit ModuleDevice(const TcpClient& module)
      : thread_([this, &module] { serve(module.fd()); }) {}
  ~ModuleDevice() {
    over_ = true;
    thread_.join();
  }

 private:
  void serve(int fd) const {
    Bytes received;
    while (!over_) {
      pollfd wait{fd, POLLIN, 0};
      std::uint8_t piece[64];
      if (::poll(&wait, 1, 5) <= 0) continue;
      const ssize_t count = ::recv(fd, piece, sizeof piece, MSG_DONTWAIT);
      if (count <= 0) continue;
      append(received, {piece, static_cast<std::size_t>(count)});
      if (received.size() < 8) continue;
      received.clear();
      static constexpr std::uint8_t kAnswer[] = {
          0x01, 0x03, 0x02, 0x00, 0x05, 0x78, 0x47};  // CRC-16/MODBUS 4778, low byte first
      ::send(fd, kAnswer, sizeof kAnswer, MSG_NOSIGNAL);
    }
  }
  std::atomic<bool> over_{false};
  std::thread thread_;
};

}  // namespace fieldcast::test
