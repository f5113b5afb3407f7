// The listening socket with all connections behind it: HTTP sessions and the WebSockets that some
// of them become. Lives on one io thread, which also runs the site.
//
// Limits: see ServerLimits. ConnectionTable decides which connection leaves beyond them.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <tl/expected.hpp>

#include "bridge/net/listener.hpp"
#include "bridge/net/tls.hpp"
#include "tools/station/web/connection_table.hpp"
#include "tools/station/web/live_socket.hpp"

namespace fieldcast::web {

struct ServerLimits {
  ConnectionLimits connections;  // without WebSockets
  // Of TLS, at the same time; one more ends the oldest.
  ConnectionLimits handshakes{.total = 32, .of_one = 16, .reserved = 0};
  ConnectionLimits live{.total = 64, .of_one = 48, .working_of_one = 48, .reserved = 16};
  std::size_t live_of_one = 8;  // WebSockets of one user who is logged in
  Duration handshake = std::chrono::seconds{10};
  Duration farewell = std::chrono::seconds{2};  // for WebSockets at the stop
  HttpLimits http;
  LiveLimits socket;
};

struct ServerCounters {
  std::uint64_t connections = 0;  // accepted so far
  std::uint64_t requests = 0;     // answered
  std::uint64_t faults = 0;       // no HTTP, no TLS, or too slow
  std::uint64_t turned_away = 0;  // connections and WebSockets beyond a limit
  std::size_t open = 0;           // connections now, without WebSockets
  std::size_t live = 0;           // WebSockets now
};

class HttpServer {
 public:
  // The site must outlive the server. `make` may be empty: there is no /live then.
  HttpServer(boost::asio::io_context& io, Site& site, MakeLiveProtocol make,
             const ServerLimits& limits = {});
  ~HttpServer();  // closes what is left, without a farewell
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  // `accepted` sockets go through TLS when there is one. Null: without.
  void serve(std::unique_ptr<TlsServer> tls);
  void accept(boost::asio::ip::tcp::socket socket);
  // For tests, too: any stream of bytes as a connection.
  void accept(std::unique_ptr<ByteStream> stream, std::string peer);

  // Closes every connection. `done` is called when all have gone, at the latest after the farewell.
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
  std::uint64_t last_id_ = 0;  // of handshakes, sessions and WebSockets
  ConnectionTable handshake_table_, session_table_, live_table_;
  std::map<std::uint64_t, std::function<void()>> handshakes_;  // what ends each
  std::map<std::uint64_t, std::shared_ptr<HttpSession>> sessions_;
  std::map<LiveSocket*, std::shared_ptr<LiveSocket>> live_;
  boost::asio::steady_timer house_, farewell_;
  std::function<void()> done_;
  std::uint64_t accepted_ = 0, turned_away_ = 0;
  bool closing_ = false;
  const std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
};

}  // namespace fieldcast::web
