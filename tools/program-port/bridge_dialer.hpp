// Connects to a bridge by TCP, or by TLS if the options say so. Runs on the io_context of main.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <memory>
#include <string>

#include "bridge/net/tls.hpp"

namespace fieldcast::port {

struct BridgeOptions {
  std::string host;
  std::uint16_t port = 0;
  bool tls = false;
  std::string authorities;  // PEM file; empty: the system's
  TlsSpec own;              // the engineer's certificate and key, if any
};

class BridgeDialer {
 public:
  BridgeDialer(boost::asio::io_context& io, BridgeOptions options);

  // Calls `done` once, unless cancelled; the error is one line. REQUIRES: no connection is pending.
  void dial(std::function<void(TlsResult)> done);
  void cancel();
  // Time of the last TCP connection: one round trip of the network.
  [[nodiscard]] Duration round_trip() const { return round_trip_; }

 private:
  void connected(unsigned attempt);
  void fail(const std::string& reason);
  void finish(TlsResult result);

  const BridgeOptions options_;
  boost::asio::ip::tcp::resolver resolver_;
  boost::asio::ip::tcp::socket socket_;
  boost::asio::steady_timer limit_;
  std::unique_ptr<TlsClient> tls_;
  std::function<void(TlsResult)> done_;
  unsigned attempt_ = 0;  // handlers of earlier attempts do nothing
  Duration round_trip_{};
};

}  // namespace fieldcast::port
