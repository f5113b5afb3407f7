// Manages TLS handshakes, HTTP sessions and WebSockets; ConnectionTable applies the limits. Runs on
// the io thread, as the site does.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <tl/expected.hpp>

#include "bridge/net/byte_stream.hpp"
#include "bridge/net/tls.hpp"
#include "tools/station/web/http_guard.hpp"
#include "tools/station/web/live_socket.hpp"

namespace fieldcast::web {

struct ServerLimits {
  ConnectionLimits connections;  // without WebSockets
  // TLS handshakes at the same time; a further one closes the oldest.
  ConnectionLimits handshakes{.total = 32, .of_one = 16, .reserved = 0};
  ConnectionLimits live{.total = 64, .of_one = 48, .working_of_one = 48, .reserved = 16};
  std::size_t live_of_one = 8;  // WebSockets of one logged-in user
  Duration handshake = std::chrono::seconds{10};
  Duration farewell = std::chrono::seconds{2};  // for WebSockets when the server closes
  HttpLimits http;
  LiveLimits socket;
};

struct ServerCounters {
  std::uint64_t connections = 0;  // accepted since start
  std::uint64_t requests = 0;     // responses sent
  std::uint64_t faults = 0;       // invalid HTTP or TLS, or timeout
  std::uint64_t turned_away = 0;  // connections and WebSockets refused or closed by a limit
  std::size_t open = 0;           // current connections without WebSockets
  std::size_t live = 0;           // current WebSockets
};

class HttpServer {
 public:
  // The site must outlive the server. If `make` is empty, /live does not exist.
  HttpServer(boost::asio::io_context& io, Site& site, MakeLiveProtocol make,
             const ServerLimits& limits = {});
  ~HttpServer();  // closes all connections without a farewell
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  // Sockets passed to accept() use TLS, or plain TCP if `tls` is null.
  void serve(std::unique_ptr<TlsServer> tls);
  void accept(boost::asio::ip::tcp::socket socket);
  // Accepts any byte stream as a connection; also for tests.
  void accept(std::unique_ptr<ByteStream> stream, std::string peer);

  // Closes every connection. Calls `done` when all are closed, at the latest after the farewell.
  void close(std::function<void()> done);

  [[nodiscard]] ServerCounters counters() const;

 private:
  void shake_hands(boost::asio::ip::tcp::socket socket, std::string peer);
  void forget_handshakes();
  [[nodiscard]] bool admit(const ConnectionTable::Admission& admission);
  [[nodiscard]] std::optional<HttpResponse> refuse_live(const Site::Upgrade& who);
  void open_live(LiveRequest request);
  void end_logins(std::uint64_t id);
  void keep_house();
  void look_for_end();

  boost::asio::io_context& io_;
  Site& site_;
  const MakeLiveProtocol make_;
  const ServerLimits limits_;
  HttpSession::Server shared_;
  std::unique_ptr<TlsServer> tls_;
  std::uint64_t last_id_ = 0;  // shared by handshakes, sessions and WebSockets
  ConnectionTable handshake_table_, session_table_, live_table_;
  // function that cancels the handshake
  std::map<std::uint64_t, std::function<void()>> handshakes_;
  std::map<std::uint64_t, std::shared_ptr<HttpSession>> sessions_;
  std::map<LiveSocket*, std::shared_ptr<LiveSocket>> live_;
  boost::asio::steady_timer house_, farewell_;
  std::function<void()> done_;
  std::uint64_t accepted_ = 0, turned_away_ = 0;
  bool closing_ = false;
  const std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
};

}  // namespace fieldcast::web
