#include <dlfcn.h>
#include <gmock/gmock.h>
#include <netdb.h>
#include <netinet/tcp.h>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <condition_variable>
#include <future>
#include <mutex>
#include <string_view>

#include "bridge/base/io_thread.hpp"
#include "bridge/port/stream_port.hpp"
#include "tests/bridge/support/port_probe.hpp"

namespace {

constexpr const char* kSilentName = "plc-7.behind-silent-name-servers.invalid";

// Name servers that do not respond: the C library waits for them.
class SilentServers {
 public:
  void wait() {
    std::unique_lock lock(mutex_);
    is_asked_ = true;
    changed_.notify_all();
    changed_.wait(lock, [this] { return responds_; });
  }
  [[nodiscard]] bool is_asked() {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds{10}, [this] { return is_asked_; });
  }
  void respond() {
    const std::lock_guard lock(mutex_);
    responds_ = true;
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool is_asked_ = false, responds_ = false;
};
auto& silent_servers = *new SilentServers;  // its threads may outlive the test

}  // namespace

// Replaces the function of the C library for the ports of this program.
extern "C" int getaddrinfo(const char* host, const char* service, const addrinfo* hints,
                           addrinfo** list) {
  if (host != nullptr && std::string_view(host) == kSilentName) {
    silent_servers.wait();
    return EAI_AGAIN;
  }
  static const auto library =
      reinterpret_cast<decltype(&getaddrinfo)>(::dlsym(RTLD_NEXT, "getaddrinfo"));
  return library(host, service, hints, list);
}

namespace fieldcast::test {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using testing::HasSubstr;

struct TcpPortTest : testing::Test {
  TcpPortSpec spec() const {
    TcpPortSpec made;
    made.host = "127.0.0.1";
    made.port = acceptor.local_endpoint().port();
    return made;
  }
  void connect(TcpPort& port) {
    acceptor.async_accept(peer, [](boost::system::error_code) {});
    port.open(probe);
    ASSERT_TRUE(run_until(io, [this] { return probe.opened == 1 && peer.is_open(); }));
  }

  asio::io_context io{1};
  tcp::acceptor acceptor{io, tcp::endpoint{asio::ip::address_v4::loopback(), 0}};
  tcp::socket peer{io};
  PortProbe probe;
};

TEST_F(TcpPortTest, CarriesBytesBothWays) {
  TcpPort port(io, spec());
  connect(port);
  const Bytes request{0, 1, 2, 0xFF}, answer{9, 8, 7};
  port.write(request);
  Bytes received(request.size());
  asio::async_read(peer, asio::buffer(received), [](boost::system::error_code, std::size_t) {});
  ASSERT_TRUE(run_until(io, [&] { return received == request; }));
  asio::write(peer, asio::buffer(answer));
  ASSERT_TRUE(run_until(io, [&] { return probe.received.size() == answer.size(); }));
  EXPECT_EQ(probe.received, answer);
}

TEST_F(TcpPortTest, ReceivedBytesAreDroppedOnlyIfNoOtherRequestWaits) {
  TcpPort port(io, spec());
  connect(port);
  asio::write(peer, asio::buffer(Bytes{1}));
  port.write(Bytes{0});
  asio::write(peer, asio::buffer(Bytes{2}));
  port.write_more(Bytes{0});
  asio::write(peer, asio::buffer(Bytes{3}));
  ASSERT_TRUE(run_until(io, [&] { return !probe.received.empty() && probe.received.back() == 3; }));
  EXPECT_EQ(probe.received, (Bytes{2, 3}));
}

TEST_F(TcpPortTest, AServerWithOneClientThatClosesImmediatelyIsInUse) {
  TcpPortSpec one = spec();
  one.fence.kind = Fence::kOneClient;
  TcpPort port(io, one);
  connect(port);
  peer.close();
  ASSERT_TRUE(run_until(io, [this] { return !probe.closed.empty(); }));
  EXPECT_THAT(probe.closed.front(), HasSubstr("another client is connected"));
}

TEST_F(TcpPortTest, AClosedPeerIsNotifiedOnce) {
  TcpPort port(io, spec());
  connect(port);
  peer.close();
  ASSERT_TRUE(run_until(io, [this] { return !probe.closed.empty(); }));
  port.write(Bytes{1});
  io.restart();
  io.poll();
  EXPECT_THAT(probe.closed, testing::ElementsAre(HasSubstr("closed by the peer")));
}

TEST_F(TcpPortTest, ARefusedConnectionIsReported) {
  const TcpPortSpec target = spec();
  acceptor.close();
  TcpPort port(io, target);
  port.open(probe);
  ASSERT_TRUE(run_until(io, [this] { return !probe.closed.empty(); }));
  EXPECT_THAT(probe.closed.front(), HasSubstr("refused"));
}

TEST_F(TcpPortTest, ConnectingEndsAtItsTimeout) {
  // With a full backlog, the kernel ignores further connection requests.
  tcp::acceptor full{io};
  full.open(tcp::v4());
  full.bind({asio::ip::address_v4::loopback(), 0});
  full.listen(0);
  std::vector<tcp::socket> crowd;
  for (int i = 0; i < 4; ++i) {
    crowd.emplace_back(io);
    crowd.back().async_connect(full.local_endpoint(), [](boost::system::error_code) {});
  }
  io.run_for(std::chrono::milliseconds{20});
  TcpPortSpec target = spec();
  target.port = full.local_endpoint().port();
  target.connect_timeout = std::chrono::milliseconds{50};
  TcpPort port(io, target);
  port.open(probe);
  ASSERT_TRUE(run_until(io, [this] { return !probe.closed.empty(); }));
  EXPECT_THAT(probe.closed.front(), HasSubstr("within 50ms"));
}

TEST_F(TcpPortTest, AnUnknownHostIsReported) {
  TcpPortSpec target = spec();
  target.host = "256.1.1.1.invalid.";
  target.connect_timeout =
      std::chrono::milliseconds{500};  // the resolver may be slow without a name server
  TcpPort port(io, target);
  port.open(probe);
  ASSERT_TRUE(run_until(io, [this] { return !probe.closed.empty(); }));
  EXPECT_EQ(probe.opened, 0);
}

TEST(TcpPort, NameServersThatDoNotRespondDoNotHoldUpTheEndOfTheThread) {
  auto io = std::make_unique<IoThread>("line");
  PortProbe probe;
  std::unique_ptr<TcpPort> port;
  TcpPortSpec target;
  target.host = kSilentName;
  target.port = 502;
  io->run([&] {
    port = std::make_unique<TcpPort>(io->context(), target);
    port->open(probe);
  });
  ASSERT_TRUE(silent_servers.is_asked());
  io->run([&] { port.reset(); });
  const auto ending = std::async(std::launch::async, [&] { io.reset(); });
  EXPECT_EQ(ending.wait_for(std::chrono::seconds{10}), std::future_status::ready);
  silent_servers.respond();
}

TEST_F(TcpPortTest, NothingIsReportedAfterClose) {
  TcpPort port(io, spec());
  connect(port);
  asio::write(peer, asio::buffer("xyz", 3));
  port.close();
  io.restart();
  io.poll();
  EXPECT_EQ(probe.deliveries, 0);
  EXPECT_TRUE(probe.closed.empty());
}

}  // namespace
}  // namespace fieldcast::test
