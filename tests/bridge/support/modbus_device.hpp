// A scripted Modbus RTU device, unit 1, on the other end of a pseudo-terminal, with its own thread.
// It supports function 03, where register r holds r until it is written, and 06, and refuses
// others. Written from the standard, independently of the core's codec.
#pragma once

#include <atomic>
#include <map>
#include <mutex>
#include <thread>

#include "tests/bridge/support/pty.hpp"

namespace fieldcast::test {

class ModbusDevice {
 public:
  explicit ModbusDevice(const Pty& pty) : pty_(pty), thread_([this] { serve(); }) {}
  ~ModbusDevice() { stop(); }
  void stop() {
    running_ = false;
    if (thread_.joinable()) thread_.join();
  }

  void set_silent(bool silent) { silent_ = silent; }
  [[nodiscard]] unsigned reads() const { return reads_; }
  [[nodiscard]] unsigned writes() const { return writes_; }
  [[nodiscard]] std::uint16_t held(std::uint16_t number) {
    const std::lock_guard lock(mutex_);
    return value_of(number);
  }

 private:
  static std::uint16_t crc(ByteView bytes) {
    std::uint16_t sum = 0xFFFF;
    for (const std::uint8_t byte : bytes) {
      sum = static_cast<std::uint16_t>(sum ^ byte);
      for (int bit = 0; bit < 8; ++bit)
        sum = static_cast<std::uint16_t>((sum & 1) != 0 ? (sum >> 1) ^ 0xA001 : sum >> 1);
    }
    return sum;
  }
  std::uint16_t value_of(std::uint16_t number) const {
    const auto found = written_.find(number);
    return found == written_.end() ? number : found->second;
  }

  void serve() {
    Bytes received;
    while (running_) {
      pollfd wait{pty_.master(), POLLIN, 0};
      if (::poll(&wait, 1, 5) <= 0) continue;
      append(received, pty_.take());
      while (received.size() >= 8 && received.size() >= length_of(received)) {
        const auto end = received.begin() + static_cast<std::ptrdiff_t>(length_of(received));
        const Bytes request(received.begin(), end);
        received.erase(received.begin(), end);
        answer(request);
      }
    }
  }
  // In functions 15 and 16, the values follow a byte count.
  static std::size_t length_of(const Bytes& request) {
    return request[1] == 15 || request[1] == 16 ? 9u + request[6] : 8u;
  }
  void answer(const Bytes& request) {
    if (silent_ || request[0] != 1) return;
    const std::lock_guard lock(mutex_);
    Bytes reply{1, request[1]};
    if (request[1] == 3) {
      const std::uint16_t count = read_u16(request, 4);
      reply.push_back(static_cast<std::uint8_t>(2 * count));
      for (std::uint16_t i = 0; i < count; ++i)
        append_u16(reply, value_of(static_cast<std::uint16_t>(read_u16(request, 2) + i)));
      ++reads_;
    } else if (request[1] == 6) {
      written_[read_u16(request, 2)] = read_u16(request, 4);
      reply.assign(request.begin(), request.begin() + 6);
      ++writes_;
    } else {
      reply[1] |= 0x80;  // illegal function
      reply.push_back(1);
    }
    const std::uint16_t sum = crc(reply);
    reply.push_back(static_cast<std::uint8_t>(sum));
    reply.push_back(static_cast<std::uint8_t>(sum >> 8));
    pty_.send(reply);
  }

  const Pty& pty_;
  std::mutex mutex_;
  std::map<std::uint16_t, std::uint16_t> written_;
  std::atomic<bool> running_{true}, silent_{false};
  std::atomic<unsigned> reads_{0}, writes_{0};
  std::thread thread_;
};

}  // namespace fieldcast::test
