// A station that serves on a port of the loopback; its WebSockets echo.
#pragma once

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

}  // namespace fieldcast::web
