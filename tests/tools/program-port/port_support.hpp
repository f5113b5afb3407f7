#pragma once

#include <fcntl.h>
#include <termios.h>

#include <filesystem>

#include "bridge/base/file_descriptor.hpp"
#include "tests/bridge/program/program_support.hpp"
#include "tests/bridge/support/process.hpp"

namespace fieldcast::test {

// The virtual port, opened raw. Closed by the destructor.
class SerialSoftware {
 public:
  explicit SerialSoftware(const std::string& path, speed_t speed = B9600, tcflag_t stop = 0)
      : fd_(::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK)) {
    EXPECT_TRUE(fd_.valid()) << path << ": " << errno_text(errno);
    set(speed, stop);
  }
  void set(speed_t speed, tcflag_t stop) const {
    termios settings{};
    ::tcgetattr(fd_.get(), &settings);
    ::cfmakeraw(&settings);
    settings.c_cflag = (settings.c_cflag & ~static_cast<tcflag_t>(CSTOPB)) | stop | CREAD | CLOCAL;
    ::cfsetspeed(&settings, speed);
    ::tcsetattr(fd_.get(), TCSANOW, &settings);
  }
  void send(std::string_view text) const {
    EXPECT_EQ(::write(fd_.get(), text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  [[nodiscard]] std::string receive(std::size_t count) const {
    std::string out;
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds{10};
    while (out.size() < count && std::chrono::steady_clock::now() < deadline) {
      pollfd wait{fd_.get(), POLLIN, 0};
      ::poll(&wait, 1, 20);
      char piece[4096];
      const ssize_t size = ::read(fd_.get(), piece, sizeof piece);
      if (size > 0) out.append(piece, static_cast<std::size_t>(size));
    }
    return out;
  }

 private:
  FileDescriptor fd_;
};

struct PortFixture : ServerFixture {
  PortFixture() {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder = std::filesystem::path(testing::TempDir()) /
             ("fieldcast-port-" + std::to_string(::getpid()) + info->name());
    std::filesystem::create_directories(folder);
    link = folder / "plc";
  }
  ~PortFixture() override { std::filesystem::remove_all(folder); }

  [[nodiscard]] std::vector<std::string> arguments(std::vector<std::string> more = {}) const {
    std::vector<std::string> all{"--server", "127.0.0.1:" + std::to_string(server.engineers_port()),
                                 "--device", "17",
                                 "--link",   link};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  // Waits until the module is registered, so that an engineer can pair with it.
  void wait_for_module() const {
    TcpClient client = engineer();
    EXPECT_EQ(pair(client, "17"), "@@0000FEFF");
    client.send("@@EDFEFF@@nobody1FEFF");  // the refusal arrives when the device is free again
    EXPECT_EQ(client.receive("FEFF"), "@@0001FEFF");
  }

  std::filesystem::path folder, link;
};

}  // namespace fieldcast::test
