// Serves HTTP/1.1 over TCP or TLS, within the limits of ConnectionTable. Runs on the io thread.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "bridge/http/http_guard.hpp"
#include "bridge/http/http_session.hpp"
#include "bridge/net/byte_stream.hpp"
#include "bridge/net/tls.hpp"

namespace fieldcast::web {

struct ServerLimits {
  ConnectionLimits connections;
  // TLS handshakes at the same time; a further one closes the oldest.
  ConnectionLimits handshakes{.total = 32, .of_one = 16, .reserved = 0};
  Duration handshake = std::chrono::seconds{10};
  HttpLimits http;
};

struct ServerCounters {
  std::uint64_t connections = 0;  // accepted since start
  std::uint64_t requests = 0;     // responses sent
  std::uint64_t faults = 0;       // invalid HTTP or TLS, or timeout
  std::uint64_t turned_away = 0;  // connections refused or closed by a limit
  std::size_t open = 0;           // current connections without WebSockets
};

class HttpServer {
 public:
  // The service must outlive the server.
  HttpServer(boost::asio::io_context& io, HttpService& service, const ServerLimits& limits);
  ~HttpServer();  // as close()
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  // Sockets passed to accept() use TLS, or plain TCP if `tls` is null.
  void serve(std::unique_ptr<TlsServer> tls);
  void accept(boost::asio::ip::tcp::socket socket);
  // Accepts any byte stream as a connection; also for tests.
  void accept(std::unique_ptr<ByteStream> stream, std::string peer);
  // Closes every connection immediately, and each later one.
  void close();

  [[nodiscard]] ServerCounters counters() const;

 private:
  void shake_hands(boost::asio::ip::tcp::socket socket, std::string peer);
  void forget_handshakes();
  [[nodiscard]] bool admit(const ConnectionTable::Admission& admission);

  HttpSession::Server shared_;
  const Duration handshake_limit_;
  std::unique_ptr<TlsServer> tls_;
  std::uint64_t last_id_ = 0;  // shared by handshakes and sessions
  ConnectionTable handshake_table_, session_table_;
  // function that cancels the handshake
  std::map<std::uint64_t, std::function<void()>> handshakes_;
  std::map<std::uint64_t, std::shared_ptr<HttpSession>> sessions_;
  std::uint64_t accepted_ = 0, turned_away_ = 0;
  bool closing_ = false;
};

}  // namespace fieldcast::web
