// A Modbus TCP device for many connections, as used by two bridges. It records the connection of
// each request. Every read of register 0 returns a greater value.
//
// Serves on its own thread; the functions are for the thread of the test.
#pragma once

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "bridge/base/file_descriptor.hpp"

namespace fieldcast::test {

class TcpDevice {
 public:
  using Clock = std::chrono::steady_clock;
  struct Request {
    Clock::time_point at;
    int connection = 0;  // counted from 1
    std::uint8_t function = 0;
    std::uint16_t address = 0, value = 0;
  };

  TcpDevice() {
    listening_.reset(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    (void)::bind(listening_.get(), reinterpret_cast<sockaddr*>(&address), sizeof address);
    (void)::listen(listening_.get(), 8);
    socklen_t size = sizeof address;
    (void)::getsockname(listening_.get(), reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] { serve(); });
  }
  ~TcpDevice() {
    ending_ = true;
    thread_.join();
  }
  TcpDevice(const TcpDevice&) = delete;
  TcpDevice& operator=(const TcpDevice&) = delete;

  [[nodiscard]] std::uint16_t port() const { return port_; }
  [[nodiscard]] std::vector<Request> requests() {
    const std::lock_guard lock(mutex_);
    return requests_;
  }
  [[nodiscard]] std::map<std::uint16_t, int> writes() {
    const std::lock_guard lock(mutex_);
    std::map<std::uint16_t, int> count;
    for (const Request& request : requests_) {
      if (request.function == 6 || request.function == 16) ++count[request.value];
    }
    return count;
  }
  // Closes the connection of a request for a unit whose bit is not set, and of one that does not
  // read holding registers.
  void close_unless_reads_of(std::uint64_t units) { units_ = units; }
  // Each connection carries one exchange.
  void close_after_answers() { closes_ = true; }
  void answer_writes_after(std::chrono::milliseconds time) { write_delay_ = time; }

 private:
  struct Connection {
    FileDescriptor socket;
    int number = 0;
    std::string bytes;
  };

  void serve() {
    while (!ending_) {
      std::vector<pollfd> sources{{listening_.get(), POLLIN, 0}};
      for (const Connection& each : connections_) sources.push_back({each.socket.get(), POLLIN, 0});
      if (::poll(sources.data(), sources.size(), 20) <= 0) continue;
      for (std::size_t i = connections_.size(); i-- > 0;) {
        if (sources[i + 1].revents != 0 && !read(connections_[i]))
          connections_.erase(connections_.begin() + static_cast<std::ptrdiff_t>(i));
      }
      if (sources[0].revents != 0) accept();
    }
  }
  void accept() {
    FileDescriptor socket(::accept4(listening_.get(), nullptr, nullptr, SOCK_CLOEXEC));
    if (!socket.valid()) return;
    const int yes = 1;
    ::setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    connections_.push_back({std::move(socket), ++accepted_, {}});
  }
  bool read(Connection& from) {
    char buffer[1024];
    const ssize_t size = ::recv(from.socket.get(), buffer, sizeof buffer, 0);
    if (size <= 0) return false;
    from.bytes.append(buffer, static_cast<std::size_t>(size));
    // MBAP: transaction 2, protocol 2, length 2, unit 1, then the function.
    while (from.bytes.size() >= 8) {
      const bool serves = units_ >> (from.bytes[6] & 63) & 1 && from.bytes[7] == 3;
      if (units_ != 0 && !serves) return false;
      const std::size_t whole = 6U + word(from.bytes, 4);
      if (from.bytes.size() < std::max<std::size_t>(whole, 12)) break;
      answer(from, from.bytes.substr(0, whole));
      from.bytes.erase(0, whole);
      if (closes_) return false;
    }
    return true;
  }
  void answer(const Connection& from, const std::string& request) {
    const auto function = static_cast<std::uint8_t>(request[7]);
    const std::uint16_t address = word(request, 8);
    const std::uint16_t value = word(request, function == 16 ? 13 : 10);
    {
      const std::lock_guard lock(mutex_);
      requests_.push_back({Clock::now(), from.number, function, address, value});
    }
    std::string answer = request.substr(0, 8);
    if (function == 3) {
      answer += static_cast<char>(2 * value);
      for (std::uint16_t i = 0; i < value; ++i) {
        const std::uint16_t item = address + i == 0 ? ++counter_ : registers_[address + i];
        answer += static_cast<char>(item >> 8);
        answer += static_cast<char>(item & 0xFF);
      }
    } else {
      registers_[address] = value;
      answer = request.substr(0, 12);
      if (write_delay_.load().count() > 0) std::this_thread::sleep_for(write_delay_.load());
    }
    const auto length = static_cast<std::uint16_t>(answer.size() - 6);
    answer[4] = static_cast<char>(length >> 8);
    answer[5] = static_cast<char>(length & 0xFF);
    (void)!::send(from.socket.get(), answer.data(), answer.size(), MSG_NOSIGNAL);
  }
  static std::uint16_t word(const std::string& bytes, std::size_t at) {
    return static_cast<std::uint16_t>(static_cast<std::uint8_t>(bytes[at]) << 8 |
                                      static_cast<std::uint8_t>(bytes[at + 1]));
  }

  FileDescriptor listening_;
  std::uint16_t port_ = 0;
  std::vector<Connection> connections_;
  int accepted_ = 0;
  std::uint16_t counter_ = 0;
  std::map<int, std::uint16_t> registers_;
  std::mutex mutex_;
  std::vector<Request> requests_;
  std::atomic<std::chrono::milliseconds> write_delay_{std::chrono::milliseconds{0}};
  std::atomic<std::uint64_t> units_ = 0;  // 0: all
  std::atomic<bool> closes_ = false;
  std::atomic<bool> ending_ = false;
  std::thread thread_;
};

}  // namespace fieldcast::test
