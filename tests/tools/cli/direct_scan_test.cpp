#include <poll.h>

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <filesystem>
#include <thread>

#include "config/loader/loader.hpp"
#include "core/codec/checksum.hpp"
#include "tests/bridge/support/tcp_device.hpp"
#include "tests/tools/cli/direct_fixture.hpp"

namespace fieldcast::cli {
namespace {

using testing::Not;

TEST_F(DirectTest, ScanFindsTheDeviceAndWritesNothingToIt) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("fieldcast-scan-" + std::to_string(::getpid()));
  std::filesystem::create_directory(folder);
  const std::string file = folder / "found.yaml";
  const auto ended = scan({.port = pty.path(),
                           .baud = 115200,
                           .format = "8N1",
                           .addresses = "1-2",
                           .timeout = std::chrono::milliseconds{300},
                           .out = file});
  EXPECT_EQ(ended.code, ExitCode::kOk) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("modbus-rtu 115200 8N1"));
  EXPECT_EQ(device.writes(), 0u);
  const auto loaded = config::load_file(file);
  EXPECT_TRUE(loaded);
  // An existing file is never overwritten.
  EXPECT_EQ(scan({.port = pty.path(),
                  .baud = 115200,
                  .format = "8N1",
                  .addresses = "1",
                  .timeout = std::chrono::milliseconds{300},
                  .out = file})
                .code,
            ExitCode::kUsage);
  std::filesystem::remove_all(folder);
}

TEST_F(DirectTest, ScanSaysWhichProtocolWasMeant) {
  const auto ended = scan({.port = pty.path(), .protocols = {"modbus-rtz"}});
  EXPECT_EQ(ended.code, ExitCode::kUsage);
  EXPECT_THAT(ended.err, HasSubstr("protocol 'modbus-rtz' is unknown; did you mean modbus-rtu?"));
}

TEST_F(DirectTest, ScanOfAControllerHasNoAddresses) {
  const auto ended = scan({.port = "127.0.0.1:102", .protocols = {"s7-tcp"}, .addresses = "1-4"});
  EXPECT_EQ(ended.code, ExitCode::kUsage);
  EXPECT_THAT(ended.err, HasSubstr("--addresses is for devices of a line; HOST:PORT of s7-tcp"));
}

// A line that echoes every byte and has no device.
struct EchoTest : DirectTest {
  EchoTest() {
    device.stop();
    echo = std::thread([this] {
      while (running) {
        pollfd wait{pty.master(), POLLIN, 0};
        if (::poll(&wait, 1, 5) > 0) pty.send(pty.take());
      }
    });
  }
  ~EchoTest() override {
    running = false;
    echo.join();
  }
  std::atomic<bool> running = true;
  std::thread echo;
};

TEST_F(EchoTest, AScanSaysThatWhatWasSentComesBack) {
  const auto ended = scan({.port = pty.path(),
                           .baud = 115200,
                           .format = "8N1",
                           .addresses = "1-4",
                           .timeout = std::chrono::milliseconds{300}});
  EXPECT_EQ(ended.code, ExitCode::kNothing);
  EXPECT_THAT(ended.err, HasSubstr("what was sent comes back, and nothing else"));
  EXPECT_THAT(ended.err, Not(HasSubstr("another master")));
}

// Two devices with address 1: each response has a wrong CRC or is too long.
struct CollisionTest : DirectTest {
  CollisionTest() { device.stop(); }
  Ended scan_with(const Bytes& answer) {
    std::atomic<bool> running = true;
    std::thread devices([&] {
      while (running) {
        pollfd wait{pty.master(), POLLIN, 0};
        if (::poll(&wait, 1, 5) <= 0) continue;
        Bytes all = answer;
        all[1] = pty.take()[1];  // function code
        pty.send(all);
      }
    });
    auto ended = scan({.port = pty.path(),
                       .baud = 115200,
                       .format = "8N1",
                       .addresses = "1",
                       .timeout = std::chrono::milliseconds{100}});
    running = false;
    devices.join();
    return ended;
  }
};

TEST_F(CollisionTest, AScanSaysThatTwoDevicesHaveTheAddress) {
  for (const Bytes& answer : {Bytes{1, 3, 2, 0, 5, 0, 0}, Bytes{1, 3, 2, 0, 5, 0, 0, 1, 3, 2, 0}}) {
    const auto ended = scan_with(answer);
    EXPECT_EQ(ended.code, ExitCode::kNothing);
    EXPECT_THAT(ended.err,
                HasSubstr("address 1, modbus-rtu 115200 8N1: bytes arrive that are not a "
                          "valid response; they begin like its response"));
    EXPECT_THAT(ended.err, HasSubstr("two devices"));
    EXPECT_THAT(ended.err, Not(HasSubstr("the settings are others")));
  }
}

TEST_F(CollisionTest, AScanSaysThatResponsesAreCut) {
  const auto ended = scan_with(Bytes{1, 3, 2, 0});
  EXPECT_EQ(ended.code, ExitCode::kNothing);
  EXPECT_THAT(ended.err, HasSubstr("the end is missing"));
}

TEST_F(DirectTest, ScanTakesARelativePath) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("fieldcast-port-" + std::to_string(::getpid()));
  std::filesystem::create_directory(folder);
  std::filesystem::create_symlink(pty.path(), folder / "adapter");
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder);
  const auto ended = scan({.port = "adapter",
                           .baud = 115200,
                           .format = "8N1",
                           .addresses = "1",
                           .timeout = std::chrono::milliseconds{300}});
  std::filesystem::current_path(before);
  std::filesystem::remove_all(folder);
  EXPECT_EQ(ended.code, ExitCode::kOk) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("modbus-rtu 115200 8N1"));
}

TEST_F(EchoTest, AReadSaysThatWhatWasSentComesBack) {
  const auto ended = read({.line = line(), .addresses = {"holding:5"}});
  EXPECT_EQ(ended.code, ExitCode::kFailed);
  EXPECT_THAT(ended.err, HasSubstr("what was sent comes back, and nothing else"));
}

// Regression: the scan ended at the first unit for which the gateway closed the connection.
TEST_F(DirectTest, ScanGoesOnWhenAGatewayClosesTheConnection) {
  test::TcpDevice gateway;
  gateway.close_unless_reads_of(1u << 3 | 1u << 5);  // nor does it identify a unit
  const auto ended = scan({.port = "127.0.0.1:" + std::to_string(gateway.port()),
                           .addresses = "1-6",
                           .timeout = std::chrono::seconds{2},
                           .json = true});
  EXPECT_EQ(ended.code, ExitCode::kOk) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr(R"("address":3)"));
  EXPECT_THAT(ended.out, HasSubstr(R"("address":5)"));
  EXPECT_THAT(ended.out, Not(HasSubstr(R"("address":4)")));
}

// Regression: the file had a plain TCP device, for which the bridge plans no silence and no time of
// the line.
TEST_F(DirectTest, ScanOfASerialServerWritesItsLine) {
  boost::asio::io_context io;
  boost::asio::ip::tcp::acceptor acceptor{io, {boost::asio::ip::address_v4::loopback(), 0}};
  std::jthread server([&] {
    boost::asio::ip::tcp::socket peer = acceptor.accept();
    boost::system::error_code closed;
    Bytes request(8);
    while (!closed) {
      request.resize(8);
      request.resize(peer.read_some(boost::asio::buffer(request), closed));
      if (request.size() < 8 || request[1] != 3) continue;
      Bytes response(3 + 2 * request[5]);
      response[0] = 1;
      response[1] = 3;
      response[2] = static_cast<std::uint8_t>(2 * request[5]);
      append_crc16(response);
      boost::asio::write(peer, boost::asio::buffer(response), closed);
    }
  });
  const std::string file = std::filesystem::temp_directory_path() /
                           ("fieldcast-" + std::to_string(::getpid()) + ".yaml");
  const auto ended = scan({.port = "127.0.0.1:" + std::to_string(acceptor.local_endpoint().port()),
                           .protocols = {"modbus-rtu"},
                           .baud = 38400,
                           .format = "8N1",
                           .addresses = "1",
                           .timeout = std::chrono::milliseconds{300},
                           .out = file});
  EXPECT_EQ(ended.code, ExitCode::kOk) << ended.err;
  const auto loaded = config::load_file(file);
  ASSERT_TRUE(loaded);
  EXPECT_EQ(to_text(line_of(loaded->buses.front().port)), "38400 8N1");
  std::filesystem::remove(file);
}

TEST_F(DirectTest, ScanSaysThatNobodyResponds) {
  device.set_silent(true);
  const auto ended = scan({.port = pty.path(),
                           .baud = 9600,
                           .format = "8N1",
                           .addresses = "1",
                           .timeout = std::chrono::milliseconds{20}});
  EXPECT_EQ(ended.code, ExitCode::kNothing);
  EXPECT_THAT(ended.err, HasSubstr("no device responded to 2 requests"));
  EXPECT_EQ(ended.out, "");
}

}  // namespace
}  // namespace fieldcast::cli
