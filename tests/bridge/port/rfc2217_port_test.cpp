#include "bridge/port/rfc2217_port.hpp"

#include <gmock/gmock.h>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>

#include "core/telnet/line_server.hpp"
#include "tests/bridge/support/port_probe.hpp"

namespace fieldcast::test {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using testing::ElementsAre;
using testing::HasSubstr;

const LineFormat kLine{115200, 7, Parity::kEven, 2};

// One connection to a server of RFC 2217 on 127.0.0.1. `received` has the data for its line.
class Rfc2217Server {
 public:
  explicit Rfc2217Server(asio::io_context& io)
      : acceptor_(io, tcp::endpoint{asio::ip::address_v4::loopback(), 0}), peer_(io) {
    accept();
  }
  [[nodiscard]] std::uint16_t port() const { return acceptor_.local_endpoint().port(); }

  void send(ByteView data) {
    Bytes out;
    telnet::append_data(out, data);
    send_raw(out);
  }
  void send_raw(ByteView bytes) { asio::write(peer_, asio::buffer(bytes.data(), bytes.size())); }
  void close() { peer_.close(); }

  bool silent = false;              // never sends
  std::optional<LineFormat> fixed;  // the line cannot be changed
  std::uint32_t nearest = 0;        // rate that the driver sets instead; 0: the requested one
  Bytes received;
  int purges = 0, connections = 0;
  LineFormat line;

 private:
  void accept() {
    acceptor_.async_accept(peer_, [this](boost::system::error_code fault) {
      if (fault) return;
      ++connections;
      Bytes first;
      server_.emplace(first);
      server_->on_line(fixed.value_or(LineFormat{}));
      if (!silent) send_raw(first);
      read();
    });
  }
  void read() {
    peer_.async_read_some(asio::buffer(buffer_),
                          [this](boost::system::error_code fault, std::size_t size) {
                            if (fault) return peer_.close(), accept();
                            telnet::LineActions actions;
                            Bytes out;
                            server_->on_bytes({buffer_.data(), size}, actions, out);
                            for (const auto& action : actions) execute(action, out);
                            if (!silent) send_raw(out);
                            line = server_->line();
                            read();
                          });
  }
  void execute(const telnet::LineAction& action, Bytes& out) {
    if (const auto* data = std::get_if<telnet::LineData>(&action)) append(received, data->bytes);
    const auto* request = std::get_if<telnet::LineChange>(&action);
    if (request == nullptr) return;
    telnet::LineChange change = *request;
    purges += change.kind == telnet::Kind::kPurge;
    if (change.kind == telnet::Kind::kBaud && nearest != 0) change.value = nearest;
    server_->on_changed(change, !fixed, out);
  }

  tcp::acceptor acceptor_;
  tcp::socket peer_;
  std::array<std::uint8_t, 4096> buffer_{};
  std::optional<telnet::LineServer> server_;
};

struct Rfc2217PortTest : testing::Test {
  void open() {
    port.open(probe);
    ASSERT_TRUE(run_until(io, [this] { return probe.opened == 1 && server.purges == 1; }))
        << testing::PrintToString(probe.closed);
  }
  void expect_closed(const std::string& reason) {
    ASSERT_TRUE(run_until(io, [this] { return !probe.closed.empty(); }));
    EXPECT_THAT(probe.closed, ElementsAre(HasSubstr(reason)));
  }

  asio::io_context io{1};
  Rfc2217Server server{io};
  PortProbe probe;
  Rfc2217Port port{io, {"127.0.0.1", server.port(), kLine}};
};

TEST_F(Rfc2217PortTest, SetsTheLineAndCarriesEveryByte) {
  open();
  EXPECT_EQ(server.line, kLine);
  Bytes all(256);
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint8_t>(i);
  port.write(all);
  ASSERT_TRUE(run_until(io, [&] { return server.received.size() == all.size(); }));
  EXPECT_EQ(server.received, all);
  server.send(all);
  ASSERT_TRUE(run_until(io, [&] { return probe.received.size() == all.size(); }));
  EXPECT_EQ(probe.received, all);
}

TEST_F(Rfc2217PortTest, AValueThatIsNotInForceIsAFault) {
  server.fixed = LineFormat{9600, 7, Parity::kEven, 2};
  port.open(probe);
  expect_closed("the server reports baud rate 9600, configured is 115200");
  EXPECT_EQ(probe.opened, 0);
}

TEST_F(Rfc2217PortTest, AChangeByOthersClosesThePort) {
  open();
  Bytes change;
  telnet::append_message(change, {telnet::From::kServer, telnet::Kind::kParity, 1});
  server.send_raw(change);
  expect_closed("the server reports parity none, configured is even");
}

TEST_F(Rfc2217PortTest, ASilentServerIsAFaultWithinThreeSeconds) {
  server.silent = true;
  port.open(probe);
  expect_closed("has not agreed on COM-PORT-OPTION (RFC 2217) within 3s");
}

TEST_F(Rfc2217PortTest, AServerThatClosesFirstMayHaveAnotherClient) {
  port.open(probe);
  server.silent = true;
  ASSERT_TRUE(run_until(io, [this] { return server.connections == 1; }));
  server.close();
  expect_closed("another client may be connected");
  EXPECT_EQ(probe.causes, std::vector{Cause::kPortInUse});
}

TEST_F(Rfc2217PortTest, TheEndOfTheConnectionClosesThePort) {
  open();
  server.close();
  expect_closed("closed by the server");
}

TEST_F(Rfc2217PortTest, StaleBytesAreDroppedBeforeARequest) {
  open();
  server.send(Bytes{1, 2, 3});
  port.write(Bytes{0x41});
  ASSERT_TRUE(run_until(io, [this] { return !server.received.empty(); }));
  server.send(Bytes{9});
  ASSERT_TRUE(run_until(io, [this] { return !probe.received.empty(); }));
  EXPECT_EQ(probe.received, Bytes{9});
}

TEST_F(Rfc2217PortTest, PollDeliversBytesThatTheNetworkHas) {
  open();
  server.send(Bytes{7});
  port.poll();
  EXPECT_EQ(probe.received, Bytes{7});
}

TEST_F(Rfc2217PortTest, ASuspendedServerGetsNoDataUntilItResumes) {
  open();
  Bytes suspend, resume;
  telnet::append_message(suspend, {telnet::From::kServer, telnet::Kind::kSuspend});
  telnet::append_message(resume, {telnet::From::kServer, telnet::Kind::kResume});
  server.send_raw(suspend);
  port.poll();
  port.write(Bytes{0x41});
  io.restart();
  io.poll();
  EXPECT_TRUE(server.received.empty());
  server.send_raw(resume);
  ASSERT_TRUE(run_until(io, [this] { return server.received == Bytes{0x41}; }));
}

TEST_F(Rfc2217PortTest, ALeaseCarriesTwoMebibytesInBothDirections) {
  open();
  const FileDescriptor line = port.lease();
  ASSERT_TRUE(line.valid());
  Bytes all(2u << 20);
  std::uint32_t state = 1;
  for (auto& byte : all)
    byte = static_cast<std::uint8_t>((state = state * 1664525u + 1013904223u) >> 24);
  std::size_t written = 0, sent = 0;
  Bytes read;
  const bool done = run_until(
      io,
      [&] {
        constexpr std::size_t kPiece = 4096;
        std::array<std::uint8_t, kPiece> buffer;
        const ssize_t in = ::read(line.get(), buffer.data(), buffer.size());
        if (in > 0) append(read, {buffer.data(), static_cast<std::size_t>(in)});
        const ssize_t out =
            ::write(line.get(), all.data() + written, std::min(kPiece, all.size() - written));
        if (out > 0) written += static_cast<std::size_t>(out);
        // At most 64 KiB wait, because send() of the server blocks.
        const std::size_t size = std::min(kPiece, all.size() - sent);
        if (size > 0 && sent < read.size() + 65536)
          server.send(ByteView(all).subspan(sent, size)), sent += size;
        return server.received.size() == all.size() && read.size() == all.size();
      },
      std::chrono::seconds{60});
  EXPECT_TRUE(done) << server.received.size() << ' ' << read.size();
  EXPECT_EQ(server.received, all);
  EXPECT_EQ(read, all);
  port.end_lease();
  server.send(Bytes{5});
  ASSERT_TRUE(run_until(io, [this] { return probe.received == Bytes{5}; }));
}

TEST_F(Rfc2217PortTest, AnEngineerHearsTheRateThatTheServerHasSet) {
  open();
  const FileDescriptor line = port.lease();
  server.nearest = 250'000;
  std::optional<std::uint32_t> in_force;
  port.change_line({telnet::Kind::kBaud, 256'000}, [&](auto value) { in_force = value; });
  ASSERT_TRUE(run_until(io, [&] { return in_force.has_value(); }));
  EXPECT_EQ(in_force, 250'000u);
}

TEST_F(Rfc2217PortTest, AChangeThatTheServerDoesNotConfirmIsNotInForce) {
  open();
  const FileDescriptor line = port.lease();
  server.silent = true;
  bool ended = false;
  std::optional<std::uint32_t> in_force;
  const auto off = static_cast<std::uint32_t>(telnet::Control::kDtrOff);
  port.change_line({telnet::Kind::kControl, off},
                   [&](auto value) { ended = true, in_force = value; });
  server.close();
  ASSERT_TRUE(run_until(io, [&] { return ended; }));
  EXPECT_EQ(in_force, std::nullopt);
}

TEST_F(Rfc2217PortTest, ItReopensAfterClose) {
  open();
  port.close();
  probe.opened = server.purges = 0;
  open();
  EXPECT_EQ(server.connections, 2);
}

}  // namespace
}  // namespace fieldcast::test
