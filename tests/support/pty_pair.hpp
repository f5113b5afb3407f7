// Two serial ports joined by a null-modem cable: bytes written to one path are read from the other.
//
// A thread joins the masters of two pseudo-terminals; the paths are their raw slaves. Bytes pass
// immediately, without a baud rate, because the peers are real programs with their own time.
// Bounded: if a side does not read, bytes for it are dropped.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <sys/eventfd.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <thread>

namespace fieldcast::test {

class PtyPair {
 public:
  // Throws std::runtime_error if no terminal is available.
  PtyPair() : stop_(::eventfd(0, EFD_CLOEXEC)) {
    for (End* end : {&left_, &right_}) *end = open_end();
    pump_ = std::thread([this] { pump(); });
  }
  ~PtyPair() {
    const std::uint64_t one = 1;
    [[maybe_unused]] const ssize_t written = ::write(stop_, &one, sizeof one);
    pump_.join();
    for (const End& end : {left_, right_}) {
      ::close(end.master);
      ::close(end.slave);
    }
    ::close(stop_);
  }
  PtyPair(const PtyPair&) = delete;
  PtyPair& operator=(const PtyPair&) = delete;

  [[nodiscard]] const std::string& left() const { return left_.path; }
  [[nodiscard]] const std::string& right() const { return right_.path; }

 private:
  struct End {
    int master = -1,
        slave =
            -1;  // keeps the slave open; otherwise the master reports a hang-up between two users
    std::string path;
  };

  static End open_end() {
    End end;
    std::array<char, 128> name{};
    termios raw{};
    ::cfmakeraw(&raw);
    raw.c_cflag |= CREAD | CLOCAL;
    if (::openpty(&end.master, &end.slave, name.data(), &raw, nullptr) != 0)
      throw std::runtime_error("no pseudo-terminal");
    ::fcntl(end.master, F_SETFL, O_NONBLOCK);
    for (const int fd : {end.master, end.slave}) ::fcntl(fd, F_SETFD, FD_CLOEXEC);
    end.path = name.data();
    return end;
  }

  void pump() const {
    std::array<pollfd, 3> fds{pollfd{left_.master, POLLIN, 0}, pollfd{right_.master, POLLIN, 0},
                              pollfd{stop_, POLLIN, 0}};
    while (::poll(fds.data(), fds.size(), -1) >= 0 && fds[2].revents == 0) {
      for (std::size_t i = 0; i < 2; ++i) {
        std::array<std::uint8_t, 4096> buffer;
        const ssize_t count = ::read(fds[i].fd, buffer.data(), buffer.size());
        if (count <= 0) continue;
        [[maybe_unused]] const ssize_t written =
            ::write(fds[1 - i].fd, buffer.data(), static_cast<std::size_t>(count));
      }
    }
  }

  int stop_;
  End left_, right_;
  std::thread pump_;
};

}  // namespace fieldcast::test
