#include <gmock/gmock.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <future>
#include <thread>

#include "bridge/base/clock.hpp"
#include "bridge/base/io_thread.hpp"
#include "tests/tools/station/web/raw_client.hpp"
#include "tools/station/web/station_server.hpp"

namespace fieldcast::web {
namespace {

namespace asio = boost::asio;
using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::StartsWith;

// Echoes messages; sends a large frame repeatedly on request.
class EchoProtocol final : public LiveProtocol {
 public:
  EchoProtocol(const Caller& caller, LivePeer& peer, std::atomic<int>& open)
      : caller_(caller), peer_(peer), open_(open) {}
  ~EchoProtocol() override { --open_; }
  void on_open(Instant) override { peer_.send_text("hello " + caller_.user); }
  void on_text(std::string_view message, Instant now) override {
    if (message == "close") return peer_.close("as you wish");
    if (message == "flood") {
      for (int i = 0; i < 600; ++i) peer_.send_text(std::string(1024, 'f'));
      return;
    }
    if (message == "stream") return on_taken(now);
    if (message == "wake") return peer_.wake_at(now + 20ms);
    peer_.send_text("you said " + std::string(message));
  }
  void on_taken(Instant) override {
    ++frames;
    peer_.send_binary(std::make_shared<const std::string>(100'000, 'b'));
  }
  void on_wake(Instant) override { peer_.send_text("awake"); }
  void on_closed() override {}

  static inline std::atomic<int> frames = 0;

 private:
  const Caller caller_;
  LivePeer& peer_;
  std::atomic<int>& open_;
};

class HttpServerTest : public testing::Test {
 protected:
  HttpServerTest() { start({}, nullptr); }
  ~HttpServerTest() override { stop(); }

  void start(const StationLimits& limits, std::unique_ptr<TlsServer> tls) {
    run([&] {
      listener_ = std::make_unique<Listener>(io_->context(), [this](asio::ip::tcp::socket socket) {
        server_->http().accept(std::move(socket));
      });
      ASSERT_TRUE(listener_->open({"127.0.0.1", 0}));
      port_ = listener_->port();
      LoginCheck check;
      check.by_password = [](const LoginAttempt& attempt,
                             const std::function<void(LoginVerdict)>& done) {
        done(LoginGrant{attempt.user, Role::kViewer});
      };
      check.random = [this] {
        SessionStore::Secret secret{};
        secret[0] = ++secrets_;
        return secret;
      };
      site_ =
          std::make_unique<Site>(SiteSpec{.listen = {"127.0.0.1", port_}, .tls = tls != nullptr},
                                 SiteClock{steady_now, [] { return UtcTime{}; }}, check);
      site_->set_local_role(Role::kViewer);
      server_ = std::make_unique<StationServer>(
          io_->context(), *site_,
          [this](const Caller& caller, LivePeer& peer) {
            ++open_;
            return std::make_unique<EchoProtocol>(caller, peer, open_);
          },
          limits);
      server_->http().serve(std::move(tls));
    });
  }
  void stop() {
    if (!server_) return;
    std::promise<void> done;
    run([&] {
      listener_->close();
      server_->close([&done] { done.set_value(); });
    });
    EXPECT_EQ(done.get_future().wait_for(5s), std::future_status::ready);
    run([&] {
      server_.reset();
      site_.reset();
      listener_.reset();
    });
    run([] {});
    EXPECT_EQ(open_, 0);
  }
  void restart(const StationLimits& limits, std::unique_ptr<TlsServer> tls = nullptr) {
    stop();
    start(limits, std::move(tls));
  }
  void run(std::function<void()> task) {
    std::promise<void> done;
    asio::post(io_->context(), [&] {
      task();
      done.set_value();
    });
    done.get_future().get();
  }
  StationCounters counters() {
    StationCounters found;
    run([&] { found = server_->counters(); });
    return found;
  }
  RawClient live(const std::string& more = {}) {
    RawClient client(port_);
    client.send(RawClient::upgrade(port_, more));
    EXPECT_THAT(client.read_until("\r\n\r\n"), StartsWith("HTTP/1.1 101"));
    const auto greeting = client.next_frame();
    EXPECT_TRUE(greeting && greeting->second.starts_with("hello "));
    return client;
  }
  std::string log_in(const std::string& user) {
    RawClient client(port_);
    const std::string host = "127.0.0.1:" + std::to_string(port_);
    const std::string body = R"({"user":")" + user + R"(","password":"secret-1"})";
    client.send("POST /api/login HTTP/1.1\r\nHost: " + host + "\r\nOrigin: http://" + host +
                "\r\nContent-Type: application/json\r\nContent-Length: " +
                std::to_string(body.size()) + "\r\n\r\n" + body);
    client.read_until("set-cookie: ");
    return client.read_until(";");
  }

  std::unique_ptr<IoThread> io_ = std::make_unique<IoThread>("web");
  std::atomic<int> open_ = 0;
  unsigned char secrets_ = 0;
  std::uint16_t port_ = 0;
  std::unique_ptr<Listener> listener_;
  std::unique_ptr<Site> site_;
  std::unique_ptr<StationServer> server_;
};

TEST_F(HttpServerTest, AWebSocketSpeaksBothWays) {
  RawClient client(port_);
  client.send(RawClient::upgrade(port_));
  const std::string head = client.read_until("\r\n\r\n");
  EXPECT_THAT(head, StartsWith("HTTP/1.1 101 Switching Protocols\r\n"));
  EXPECT_THAT(head, HasSubstr("Sec-WebSocket-Accept: s3pPLMBiTxaQ9kYGzzhZRbK+xOo=\r\n"));
  EXPECT_THAT(head, HasSubstr("Sec-WebSocket-Protocol: fieldcast.1\r\n"));
  EXPECT_EQ(client.next_frame()->second, "hello local");
  client.send(RawClient::frame(1, "ho"));
  const auto frame = client.next_frame();
  EXPECT_EQ(frame->first, 0x81);
  EXPECT_EQ(frame->second, "you said ho");
  client.send(RawClient::frame(1, "wake"));
  EXPECT_EQ(client.next_frame()->second, "awake");
  client.send(RawClient::frame(9, "ping"));
  EXPECT_EQ(client.next_frame(), (std::pair<std::uint8_t, std::string>{0x8a, "ping"}));
}

TEST_F(HttpServerTest, AClosedWebSocketIsForgotten) {
  RawClient asks = live(), says = live(), leaves = live();
  asks.send(RawClient::frame(1, "close"));
  const auto farewell = asks.next_frame();
  EXPECT_EQ(farewell->first, 0x88);
  EXPECT_EQ(farewell->second,
            "\x03\xf0"
            "as you wish");
  asks.send(RawClient::frame(8, ""));
  EXPECT_TRUE(asks.ends());
  says.send(RawClient::frame(8, "\x03\xe8"));
  EXPECT_EQ(says.next_frame()->first, 0x88);
  EXPECT_TRUE(says.ends());
  { const RawClient gone = std::move(leaves); }
  for (int i = 0; i < 100 && open_ > 0; ++i) std::this_thread::sleep_for(10ms);
  EXPECT_EQ(open_, 0);
  EXPECT_EQ(counters().live, 0u);
}

TEST_F(HttpServerTest, AWebSocketOfAnotherSiteIsRefused) {
  for (const char* origin : {"http://evil.example", "null", "https://127.0.0.1"}) {
    RawClient client(port_);
    client.send(RawClient::upgrade(port_, "", origin));
    EXPECT_THAT(client.read_until("\r\n\r\n"), StartsWith("HTTP/1.1 403")) << origin;
    EXPECT_TRUE(client.ends());
  }
  RawClient client(port_);
  std::string request = RawClient::upgrade(port_);
  request.replace(request.find("Host: 127.0.0.1"), 15, "Host: evil.exam");
  client.send(request);
  EXPECT_THAT(client.read_until("\r\n\r\n"), StartsWith("HTTP/1.1 421"));
}

TEST_F(HttpServerTest, AWebSocketNeedsSubprotocolAndVersion) {
  for (const auto& [from, to] :
       {std::pair{"fieldcast.1", "other.1"}, std::pair{"Version: 13", "Version: 7"}}) {
    RawClient client(port_);
    std::string request = RawClient::upgrade(port_);
    request.replace(request.find(from), std::string(from).size(), to);
    client.send(request);
    EXPECT_THAT(client.read_until("\r\n\r\n"),
                testing::AnyOf(StartsWith("HTTP/1.1 400"), StartsWith("HTTP/1.1 426")))
        << to;
    EXPECT_TRUE(client.ends());
  }
  RawClient hasty(port_);
  hasty.send(RawClient::upgrade(port_) + RawClient::frame(1, "early"));
  EXPECT_THAT(hasty.read_until("\r\n\r\n"), StartsWith("HTTP/1.1 400"));
}

TEST_F(HttpServerTest, BrokenFramesEndTheWebSocket) {
  StationLimits limits;
  limits.socket.handshake = 300ms;
  restart(limits);
  const std::string unmasked = "\x81\x02ho", reserved("\xf1\x80\0\0\0\0", 6),
                    odd("\x83\x80\0\0\0\0", 6);
  for (const std::string& bytes :
       {unmasked, reserved, odd, RawClient::frame(2, "binary"), RawClient::frame(1, "\xff\xfe"),
        RawClient::frame(1, std::string(4'097, 'x')), std::string(200, '\xff')}) {
    RawClient client = live();
    client.send(bytes);
    EXPECT_TRUE(client.ends());
  }
  RawClient most = live();
  most.send(RawClient::frame(1, std::string(4'096, 'x')));
  EXPECT_EQ(most.next_frame()->second.size(), 4'096 + 9u);
}

TEST_F(HttpServerTest, ThereAreSixtyFourWebSocketsAndSixteenOfThemAreForLogins) {
  std::vector<RawClient> clients;
  for (int i = 0; i < 48; ++i) clients.push_back(live());
  const auto refused = [&](const std::string& more) {
    RawClient one_more(port_);
    one_more.send(RawClient::upgrade(port_, more));
    return one_more.read_until("\r\n\r\n");
  };
  EXPECT_THAT(refused(""), StartsWith("HTTP/1.1 503"));
  for (const std::string user : {"anna", "bert"}) {
    const std::string cookie = "Cookie: " + log_in(user) + "\r\n";
    for (int i = 0; i < 8; ++i) clients.push_back(live(cookie));
  }
  const std::string cookie = "Cookie: " + log_in("carl") + "\r\n";
  EXPECT_THAT(refused(cookie), StartsWith("HTTP/1.1 503"));
  EXPECT_EQ(counters().live, 64u);
  EXPECT_EQ(counters().turned_away, 2u);
  clients.pop_back();
  for (int i = 0; i < 100 && open_ > 63; ++i) std::this_thread::sleep_for(10ms);
  live(cookie);
}

TEST_F(HttpServerTest, OneUserHasEightAndALogoutEndsThem) {
  const std::string cookie = "Cookie: " + log_in("anna") + "\r\n";
  std::vector<RawClient> clients;
  for (int i = 0; i < 8; ++i) clients.push_back(live(cookie));
  RawClient ninth(port_);
  ninth.send(RawClient::upgrade(port_, cookie));
  EXPECT_THAT(ninth.read_until("\r\n\r\n"), StartsWith("HTTP/1.1 503"));
  RawClient other = live("Cookie: " + log_in("bert") + "\r\n");
  const std::string host = "127.0.0.1:" + std::to_string(port_);
  RawClient out(port_);
  out.send("POST /api/logout HTTP/1.1\r\nHost: " + host + "\r\nOrigin: http://" + host + "\r\n" +
           cookie + "\r\n");
  EXPECT_THAT(out.read_until("\r\n\r\n"), StartsWith("HTTP/1.1 204"));
  for (RawClient& client : clients) EXPECT_EQ(client.next_frame()->first, 0x88);
  other.send(RawClient::frame(1, "still here"));
  EXPECT_EQ(other.next_frame()->second, "you said still here");
}

TEST_F(HttpServerTest, AClientThatStopsReadingHoldsUpNobody) {
  RawClient stopped(port_, 16 * 1024);
  stopped.send(RawClient::upgrade(port_));
  EXPECT_THAT(stopped.read_until("\r\n\r\n"), StartsWith("HTTP/1.1 101"));
  EchoProtocol::frames = 0;
  stopped.send(RawClient::frame(1, "stream"));
  RawClient other = live();
  for (int i = 0; i < 20; ++i) {
    other.send(RawClient::frame(1, "quick"));
    EXPECT_EQ(other.next_frame()->second, "you said quick");
    std::this_thread::sleep_for(5ms);
  }
  // The buffers of the two kernels and one frame.
  const int frames = EchoProtocol::frames;
  EXPECT_LT(frames, 12);
  std::this_thread::sleep_for(100ms);
  EXPECT_EQ(EchoProtocol::frames, frames);
  EXPECT_EQ(stopped.next_frame()->second, "hello local");
  for (int i = 0; i < frames + 5; ++i) EXPECT_EQ(stopped.next_frame()->second.size(), 100'000u);
}

TEST_F(HttpServerTest, AClientThatLeavesTooManyTextsUnreadIsClosed) {
  RawClient client(port_, 4 * 1024);
  client.send(RawClient::upgrade(port_));
  client.read_until("hello local");
  client.send(RawClient::frame(1, "flood"));
  for (int i = 0; i < 300 && open_ > 0; ++i) std::this_thread::sleep_for(10ms);
  EXPECT_EQ(open_, 0);
}

TEST_F(HttpServerTest, AClientWithoutASignOfLifeIsClosed) {
  StationLimits limits;
  limits.socket.idle = 400ms;
  restart(limits);
  RawClient silent = live();
  EXPECT_EQ(silent.next_frame()->first, 0x89);  // a ping without a response
  EXPECT_TRUE(silent.ends());
}

TEST_F(HttpServerTest, TheStopSaysGoodbye) {
  RawClient client = live();
  std::thread stopping([this] { stop(); });
  const auto farewell = client.next_frame();
  EXPECT_EQ(farewell->first, 0x88);
  EXPECT_THAT(farewell->second, HasSubstr("the station stops"));
  client.send(RawClient::frame(8, ""));
  EXPECT_TRUE(client.ends());
  stopping.join();
}

TEST_F(HttpServerTest, AClientThatIgnoresTheGoodbyeDoesNotHoldUpTheStop) {
  StationLimits limits;
  limits.farewell = 200ms;
  restart(limits);
  const RawClient client = live();
  const auto began = std::chrono::steady_clock::now();
  stop();
  EXPECT_LT(std::chrono::steady_clock::now() - began, 2s);
}

class HttpsServerTest : public HttpServerTest {
 protected:
  void SetUp() override {
    folder_ = testing::TempDir() + "station-" + std::to_string(::getpid());
    const std::string make =
        "mkdir -p " + folder_ +
        " && openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 2 "
        "-subj /CN=station -addext subjectAltName=IP:127.0.0.1 -keyout " +
        folder_ + "/key.pem -out " + folder_ + "/cert.pem >/dev/null 2>&1";
    ASSERT_EQ(std::system(make.c_str()), 0);
    StationLimits limits;
    limits.handshake = 300ms;
    limits.handshakes = {.total = 3, .of_one = 3, .reserved = 0};
    auto tls = TlsServer::make({folder_ + "/cert.pem", folder_ + "/key.pem", {}, {}});
    ASSERT_TRUE(tls) << tls.error();
    restart(limits, *std::move(tls));
  }
  void TearDown() override { ASSERT_EQ(std::system(("rm -rf " + folder_).c_str()), 0); }
  std::string get(const std::string& path, const std::string& options) {
    const std::string command = "curl -sS --max-time 5 -w '%{http_code}' " + options +
                                " https://127.0.0.1:" + std::to_string(port_) + path + " 2>&1";
    FILE* pipe = ::popen(command.c_str(), "r");
    std::string text;
    for (int c = 0; (c = std::fgetc(pipe)) != EOF;) text += static_cast<char>(c);
    ::pclose(pipe);
    return text;
  }
  std::string folder_;
};

TEST_F(HttpsServerTest, TlsOfThePresentIsSpokenAndNothingOlder) {
  EXPECT_EQ(get("/healthz", "--cacert " + folder_ + "/cert.pem"), "ok\n200");
  EXPECT_EQ(get("/healthz", "--tls-max 1.2 --cacert " + folder_ + "/cert.pem"), "ok\n200");
  EXPECT_THAT(get("/healthz", "--tls-max 1.1 --tlsv1.0 --cacert " + folder_ + "/cert.pem"),
              HasSubstr("000"));
}

TEST_F(HttpsServerTest, OnlyEcdheWithAeadAndTls13AreSpoken) {
  const auto spoken = [this](const std::string& options) {
    const std::string command = "openssl s_client -connect 127.0.0.1:" + std::to_string(port_) +
                                " " + options + " </dev/null 2>&1";
    FILE* pipe = ::popen(command.c_str(), "r");
    std::string text;
    for (int c = 0; (c = std::fgetc(pipe)) != EOF;) text += static_cast<char>(c);
    ::pclose(pipe);
    return text;
  };
  for (const std::string suite : {"ECDHE-ECDSA-AES128-GCM-SHA256", "ECDHE-ECDSA-AES256-GCM-SHA384",
                                  "ECDHE-ECDSA-CHACHA20-POLY1305"})
    EXPECT_THAT(spoken("-tls1_2 -cipher " + suite), HasSubstr("Cipher is " + suite));
  EXPECT_THAT(spoken("-tls1_3"), HasSubstr("New, TLSv1.3, Cipher is TLS_"));
  // The alert shows that the server refuses, not the client.
  for (const std::string suite :
       {"ECDHE-ECDSA-AES128-SHA", "ECDHE-ECDSA-AES128-SHA256", "ECDHE-ECDSA-AES128-CCM",
        "AES128-GCM-SHA256", "AES128-SHA", "DHE-RSA-AES128-GCM-SHA256"})
    EXPECT_THAT(spoken("-tls1_2 -cipher " + suite + "@SECLEVEL=0"), HasSubstr("alert handshake"))
        << suite;
  for (const std::string version : {"-tls1", "-tls1_1"})
    EXPECT_THAT(spoken(version + " -cipher DEFAULT@SECLEVEL=0"),
                HasSubstr("alert protocol version"))
        << version;
}

TEST_F(HttpsServerTest, GarbageInsteadOfAHandshakeEndsTheConnectionOnly) {
  for (const std::string& bytes :
       {std::string("GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n"), std::string(3000, '\xff'),
        std::string("\x16\x03\x01\xff\xff\x01\xff\xff\xff", 9) + std::string(5000, 'x'),
        std::string(20'000, '\0')}) {
    RawClient client(port_);
    client.send(bytes);
    EXPECT_TRUE(client.ends());
  }
  EXPECT_EQ(get("/healthz", "--cacert " + folder_ + "/cert.pem"), "ok\n200");
  EXPECT_EQ(counters().faults, 4u);
}

TEST_F(HttpsServerTest, HandshakesThatNeverEndAreCutByTimeAndNumber) {
  std::vector<RawClient> clients;
  for (int i = 0; i < 5; ++i) clients.emplace_back(port_);
  for (RawClient& client : clients) EXPECT_TRUE(client.ends());
  EXPECT_EQ(counters().turned_away, 2u);
  for (int i = 0; i < 100 && counters().open > 0; ++i) std::this_thread::sleep_for(10ms);
  EXPECT_EQ(counters().open, 0u);
}

TEST_F(HttpsServerTest, HandshakesOfARenewedCertificateAreNotCounted) {
  std::vector<RawClient> clients;
  for (int i = 0; i < 3; ++i) clients.emplace_back(port_);
  for (int i = 0; i < 100 && counters().open < 3; ++i) std::this_thread::sleep_for(10ms);
  EXPECT_EQ(counters().open, 3u);
  auto tls = TlsServer::make({folder_ + "/cert.pem", folder_ + "/key.pem", {}, {}});
  ASSERT_TRUE(tls) << tls.error();
  run([&] { server_->http().serve(*std::move(tls)); });
  EXPECT_EQ(counters().open, 0u);
  EXPECT_EQ(get("/healthz", "--cacert " + folder_ + "/cert.pem"), "ok\n200");
  EXPECT_EQ(counters().turned_away, 0u);
}

}  // namespace
}  // namespace fieldcast::web
