// A pseudo-terminal pair: a SerialPort opens the slave, and the test holds the master.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <stdlib.h>
#include <unistd.h>

#include <chrono>
#include <string>

#include "bridge/base/file_descriptor.hpp"
#include "core/base/bytes.hpp"

namespace fieldcast::test {

class Pty {
 public:
  Pty() : master_(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
    char name[128] = {};
    if (!master_.valid() || ::grantpt(master_.get()) != 0 || ::unlockpt(master_.get()) != 0 ||
        ::ptsname_r(master_.get(), name, sizeof name) != 0) {
      ADD_FAILURE() << "no pseudo-terminal";
    }
    path_ = name;
  }

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] int master() const { return master_.get(); }
  void unplug() { master_.reset(); }

  void send(ByteView bytes) const {
    EXPECT_EQ(::write(master_.get(), bytes.data(), bytes.size()),
              static_cast<ssize_t>(bytes.size()));
  }
  [[nodiscard]] Bytes take() const {
    Bytes bytes(4096);
    const ssize_t size = ::read(master_.get(), bytes.data(), bytes.size());
    bytes.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
    return bytes;
  }
  // Waits for `size` bytes; returns fewer after the limit.
  [[nodiscard]] Bytes receive(std::size_t size,
                              std::chrono::milliseconds limit = std::chrono::seconds{5}) const {
    Bytes all;
    const auto deadline = std::chrono::steady_clock::now() + limit;
    while (all.size() < size && std::chrono::steady_clock::now() < deadline) {
      pollfd wait{master_.get(), POLLIN, 0};
      ::poll(&wait, 1, 20);
      append(all, take());
    }
    return all;
  }

 private:
  FileDescriptor master_;
  std::string path_;
};

}  // namespace fieldcast::test
