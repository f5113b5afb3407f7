#include "bridge/metrics/metrics_server.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <list>
#include <memory>
#include <random>
#include <thread>

#include "tests/bridge/support/captured_log.hpp"
#include "tests/bridge/support/tcp_client.hpp"

namespace fieldcast {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::CapturedLog;
using test::TcpClient;
using testing::HasSubstr;
using testing::StartsWith;

constexpr std::string_view kGet = "GET /metrics HTTP/1.1\r\nHost: h\r\n\r\n";
constexpr std::string_view kGetAndClose =
    "GET /metrics HTTP/1.1\r\nHost: h\r\nConnection: close\r\n\r\n";

template <typename Condition>
[[nodiscard]] bool eventually(Condition condition) {
  const auto deadline = std::chrono::steady_clock::now() + seconds{10};
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(milliseconds{1});
  }
  return true;
}

// Returns the open descriptors of this process, which has both ends of every connection.
[[nodiscard]] std::ptrdiff_t open_descriptors() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {});
}

struct MetricsServerTest : testing::Test {
  MetricsServerTest() { limits.try_again = milliseconds{20}; }

  void serve(std::uint16_t at = 0) {
    server = std::make_unique<MetricsServer>(
        ListenSpec{"127.0.0.1", at},
        [this](MetricsFormat format) {
          return format == MetricsFormat::kOpenMetrics ? "a 1\n# EOF\n" : text;
        },
        [this] { return fault; }, limits);
    const bool listening = at != 0 || listens();
    EXPECT_TRUE(listening);
  }
  [[nodiscard]] bool listens() const {
    return eventually([this] { return server->port() != 0; });
  }
  [[nodiscard]] std::string response_to(std::string_view request) const {
    TcpClient client(server->port());
    client.send(request);
    EXPECT_TRUE(client.is_closed());
    return client.receive("nothing ends it");
  }

  MetricsServer::Limits limits;
  std::string text = "a 1\n", fault;
  std::unique_ptr<MetricsServer> server;
};

TEST_F(MetricsServerTest, GivesTheTextInTheFormatThatIsAccepted) {
  serve();
  const std::string older = response_to(kGetAndClose);
  EXPECT_THAT(older, StartsWith("HTTP/1.1 200 OK\r\n"));
  EXPECT_THAT(older, HasSubstr("content-type: text/plain; version=0.0.4; charset=utf-8\r\n"));
  EXPECT_THAT(older, testing::EndsWith("\r\n\r\na 1\n"));
  const std::string open = response_to(
      "GET /metrics?x=1 HTTP/1.1\r\nHost: h\r\nAccept: "
      "application/openmetrics-text;version=1.0.0\r\n"
      "Connection: close\r\n\r\n");
  EXPECT_THAT(open, HasSubstr("content-type: application/openmetrics-text; version=1.0.0"));
  EXPECT_THAT(open, testing::EndsWith("# EOF\n"));
}

TEST_F(MetricsServerTest, ReportsTheHealthOfTheBridge) {
  constexpr std::string_view kHealth =
      "GET /healthz HTTP/1.1\r\nHost: h\r\nConnection: close\r\n\r\n";
  serve();
  const std::string healthy = response_to(kHealth);
  EXPECT_THAT(healthy, StartsWith("HTTP/1.1 200 OK\r\n"));
  EXPECT_THAT(healthy, testing::EndsWith("\r\n\r\nok\n"));
  fault = "line: no report for 17 s";
  const std::string unhealthy = response_to(kHealth);
  EXPECT_THAT(unhealthy, StartsWith("HTTP/1.1 503 "));
  EXPECT_THAT(unhealthy, testing::EndsWith("\r\n\r\nline: no report for 17 s\n"));
}

TEST(SilentBus, IsABusWithoutAReportForTheLimit) {
  const Instant now{seconds{1000}};
  const UtcTime clock{1'700'000'000'000'000'000};  // may be set meanwhile
  const auto bus = [&](const char* name, Duration age) {
    return std::make_shared<const BusFigures>(
        BusFigures{.bus = name, .at = clock, .reported = now - age});
  };
  EXPECT_EQ(silent_bus({}, now), "");
  EXPECT_EQ(silent_bus({.buses = {bus("line", seconds{15}), bus("hall", -seconds{3})}}, now), "");
  EXPECT_EQ(silent_bus({.buses = {bus("hall", seconds{1}), bus("line", seconds{17})}}, now),
            "line: no report for 17 s");
}

TEST_F(MetricsServerTest, AConnectionServesManyRequests) {
  serve();
  TcpClient client(server->port());
  for (int i = 0; i < 3; ++i) {
    client.send(kGet);
    EXPECT_THAT(client.receive("\r\n\r\na 1\n"), StartsWith("HTTP/1.1 200 OK\r\n"));
  }
}

TEST_F(MetricsServerTest, SeveralClientsAreServedAtTheSameTime) {
  serve();
  std::list<TcpClient> clients;
  for (std::size_t i = 0; i < limits.connections; ++i) clients.emplace_back(server->port());
  for (const TcpClient& client : clients) client.send(kGet);
  for (TcpClient& client : clients)
    EXPECT_THAT(client.receive("\r\n\r\na 1\n"), StartsWith("HTTP/1.1 200 OK\r\n"));
}

TEST_F(MetricsServerTest, OneMoreClientCutsTheOneThatWasSilentLongest) {
  serve();
  std::list<TcpClient> clients;
  for (std::size_t i = 0; i < limits.connections; ++i) {
    clients.emplace_back(server->port());
    clients.back().send(kGet);
    ASSERT_NE(clients.back().receive("\r\n\r\na 1\n"), "");
  }
  TcpClient late(server->port());
  late.send(kGet);
  EXPECT_THAT(late.receive("\r\n\r\na 1\n"), StartsWith("HTTP/1.1 200 OK\r\n"));
  EXPECT_TRUE(clients.front().is_closed());
  clients.back().send(kGet);
  EXPECT_THAT(clients.back().receive("\r\n\r\na 1\n"), StartsWith("HTTP/1.1 200 OK\r\n"));
}

TEST_F(MetricsServerTest, EverythingElseIsRefused) {
  serve();
  EXPECT_THAT(response_to("GET / HTTP/1.1\r\nHost: h\r\n\r\n"), StartsWith("HTTP/1.1 404 "));
  EXPECT_THAT(response_to("GET /metrics/x HTTP/1.1\r\nHost: h\r\n\r\n"),
              StartsWith("HTTP/1.1 404 "));
  for (const char* method : {"POST", "PUT", "DELETE", "HEAD", "OPTIONS"}) {
    const std::string response =
        response_to(fmt::format("{} /metrics HTTP/1.1\r\nHost: h\r\n\r\n", method));
    EXPECT_THAT(response, StartsWith("HTTP/1.1 405 ")) << method;
    EXPECT_THAT(response, HasSubstr("allow: GET\r\n")) << method;
  }
  EXPECT_THAT(response_to("POST /metrics HTTP/1.1\r\nContent-Length: 5\r\n\r\nhello"),
              StartsWith("HTTP/1.1 405 "));
}

TEST_F(MetricsServerTest, GarbageIsABadRequest) {
  serve();
  EXPECT_THAT(response_to("\x01\x02\x03 what is this\r\n\r\n"), StartsWith("HTTP/1.1 400 "));
  EXPECT_THAT(response_to("GET /metrics HTTP/9.9.9\r\n\r\n"), StartsWith("HTTP/1.1 400 "));
  EXPECT_THAT(response_to("GET /metrics HTTP/1.1\r\nno colon\r\n\r\n"),
              StartsWith("HTTP/1.1 400 "));
}

TEST_F(MetricsServerTest, RandomBytesEndNothingButTheirConnection) {
  limits.request = milliseconds{50};  // for an incomplete request
  serve();
  std::mt19937 random(7);
  for (int i = 0; i < 30; ++i) {
    std::string bytes(1 + random() % 200, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random());
    TcpClient client(server->port());
    client.send(bytes);
    EXPECT_TRUE(client.is_closed());
  }
  EXPECT_THAT(response_to(kGetAndClose), StartsWith("HTTP/1.1 200 OK\r\n"));
}

TEST_F(MetricsServerTest, ALongHeaderIsRefused) {
  serve();
  EXPECT_THAT(response_to("GET /metrics HTTP/1.1\r\nX: " + std::string(100'000, 'x') + "\r\n\r\n"),
              StartsWith("HTTP/1.1 431 "));
}

TEST_F(MetricsServerTest, AClientThatNeverSendsIsCut) {
  limits.request = milliseconds{100};
  serve();
  TcpClient silent(server->port()), slow(server->port());
  slow.send("GET /met");
  EXPECT_TRUE(silent.is_closed());
  EXPECT_TRUE(slow.is_closed());
}

TEST_F(MetricsServerTest, AClientThatNeverReadsIsCutAndHoldsUpNobody) {
  limits.response = milliseconds{500};
  text = std::string(32 << 20, 'x') + "\nend\n";  // far more than sockets hold
  serve();
  TcpClient never(server->port());
  never.send(kGet);
  TcpClient other(server->port());
  other.send("GET /metrics HTTP/1.1\r\nHost: h\r\nAccept: application/openmetrics-text\r\n\r\n");
  EXPECT_THAT(other.receive("# EOF\n"), StartsWith("HTTP/1.1 200 OK\r\n"));
  const std::ptrdiff_t both = open_descriptors();
  EXPECT_TRUE(eventually([&] { return open_descriptors() < both; })) << "it reads nothing so long";
  EXPECT_TRUE(never.is_closed());
  EXPECT_LT(never.receive("\nend\n").size(), text.size());
}

TEST_F(MetricsServerTest, ClientsThatReadNothingMakeWay) {
  text = std::string(8 << 20, 'x');
  serve();
  std::list<TcpClient> clients;
  for (std::size_t i = 0; i < limits.connections; ++i) {
    clients.emplace_back(server->port());
    clients.back().send(kGet);
  }
  TcpClient other(server->port());
  other.send("GET /metrics HTTP/1.1\r\nHost: h\r\nAccept: application/openmetrics-text\r\n\r\n");
  EXPECT_THAT(other.receive("# EOF\n"), StartsWith("HTTP/1.1 200 OK\r\n"));
}

TEST_F(MetricsServerTest, ATakenPortIsListenedOnWhenItIsFree) {
  serve();
  std::unique_ptr<MetricsServer> first = std::move(server);
  const std::uint16_t port = first->port();
  CapturedLog log;
  serve(port);
  EXPECT_TRUE(eventually([&] {
    return log.so_far().find("they are not served, the buses run") != std::string::npos;
  })) << log.so_far();
  EXPECT_EQ(server->port(), 0);
  first.reset();
  EXPECT_TRUE(listens());
  EXPECT_EQ(server->port(), port);
  EXPECT_THAT(response_to(kGetAndClose), StartsWith("HTTP/1.1 200 OK\r\n"));
}

TEST_F(MetricsServerTest, EndsWithPendingClients) {
  text = std::string(32 << 20, 'x');
  serve();
  TcpClient silent(server->port()), never(server->port());
  never.send(kGet);
  server.reset();
  EXPECT_TRUE(silent.is_closed());
}

}  // namespace
}  // namespace fieldcast
