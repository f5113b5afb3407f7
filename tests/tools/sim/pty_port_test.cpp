#include "tools/sim/port/pty_port.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/stat.h>

#include <array>
#include <filesystem>
#include <fstream>

#include "tools/sim/port/tcp_listener.hpp"

namespace fieldcast::sim {
namespace {

namespace fs = std::filesystem;

class PtyPortTest : public ::testing::Test {
 protected:
  PtyPortTest() {
    std::string name = (fs::temp_directory_path() / "fieldcast-pty-XXXXXX").string();
    folder_ = ::mkdtemp(name.data());
  }
  ~PtyPortTest() override { fs::remove_all(folder_); }
  [[nodiscard]] std::string path() const { return (folder_ / "line").string(); }

  fs::path folder_;
};

TEST_F(PtyPortTest, CarriesBytesThroughItsLink) {
  auto port = PtyPort::open(path());
  ASSERT_TRUE(port) << port.error();
  const FileDescriptor user(::open(path().c_str(), O_RDWR | O_NOCTTY));
  ASSERT_TRUE(user);
  const std::array<std::uint8_t, 4> sent{0x01, 0x0A, 0x0D,
                                         0xFF};  // characters that a cooked terminal would change
  ASSERT_EQ(::write(user.get(), sent.data(), sent.size()), 4);
  pollfd ready{port->fd(), POLLIN, 0};
  ASSERT_EQ(::poll(&ready, 1, 5000), 1);
  std::array<std::uint8_t, 8> got{};
  ASSERT_EQ(::read(port->fd(), got.data(), got.size()), 4);
  EXPECT_TRUE(std::equal(sent.begin(), sent.end(), got.begin()));
}

TEST_F(PtyPortTest, RemovesItsLinkAtTheEnd) {
  { ASSERT_TRUE(PtyPort::open(path())); }
  EXPECT_FALSE(fs::exists(fs::symlink_status(path())));
}

TEST_F(PtyPortTest, LeavesFilesOfOthersAlone) {
  std::ofstream(path()) << "precious";
  EXPECT_FALSE(PtyPort::open(path()));
  std::string content;
  std::ifstream(path()) >> content;
  EXPECT_EQ(content, "precious");
}

TEST_F(PtyPortTest, LeavesLinksOfOthersAlone) {
  for (const char* target : {"/dev/null", "/nowhere", "/dev/pts/9999"}) {
    fs::create_symlink(target, path());
    EXPECT_FALSE(PtyPort::open(path())) << target;
    EXPECT_EQ(fs::read_symlink(path()), target);
    fs::remove(path());
  }
}

TEST_F(PtyPortTest, TakesOverTheLinkOfAKilledSimulator) {
  fs::create_symlink("/dev/pts/../pts/9999", path());
  const auto port = PtyPort::open(path());
  ASSERT_TRUE(port) << port.error();
  EXPECT_EQ(fs::canonical(path()), port->terminal());
}

TEST_F(PtyPortTest, ALivingSimulatorKeepsItsPath) {
  const auto first = PtyPort::open(path());
  ASSERT_TRUE(first);
  const auto second = PtyPort::open(path());
  ASSERT_FALSE(second);
  EXPECT_NE(second.error().find("another program"), std::string::npos);
  EXPECT_EQ(fs::canonical(path()), first->terminal());
}

TEST_F(PtyPortTest, DoesNotRemoveWhatReplacedItsLink) {
  {
    const auto port = PtyPort::open(path());
    ASSERT_TRUE(port);
    fs::remove(path());
    std::ofstream(path()) << "precious";
  }
  EXPECT_TRUE(fs::is_regular_file(path()));
}

TEST_F(PtyPortTest, SaysWhyItCannot) {
  const auto port = PtyPort::open((folder_ / "missing" / "line").string());
  ASSERT_FALSE(port);
  EXPECT_NE(port.error().find("its folder is missing"), std::string::npos) << port.error();
}

TEST(TcpListener, ServesThisMachineOnly) {
  EXPECT_EQ(loopback_for("127.0.0.5"), "127.0.0.5");
  for (const char* host : {"10.0.0.7", "plc.example", "0.0.0.0", "localhost", "1127.0.0.1"})
    EXPECT_EQ(loopback_for(host), "127.0.0.1") << host;
}

}  // namespace
}  // namespace fieldcast::sim
