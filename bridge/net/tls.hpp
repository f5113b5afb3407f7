// TLS, both ends (OpenSSL). Lives on one io thread. TLS 1.2 and later,
// server certificates only: users log in with a password inside.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <tl/expected.hpp>

#include "bridge/net/byte_stream.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

// Else why not, in one line.
using TlsResult = tl::expected<std::unique_ptr<ByteStream>, std::string>;

class TlsServer {
 public:
  // PEM files. The error names the file.
  [[nodiscard]] static tl::expected<std::unique_ptr<TlsServer>, std::string> make(
      const std::string& certificate, const std::string& key);
  ~TlsServer();

  // `done` is called once within the limit, never inside this call; not after close(). What comes
  // back ends the handshake at once, if it still goes on.
  std::function<void()> shake_hands(boost::asio::ip::tcp::socket socket, Duration limit,
                                    std::function<void(TlsResult)> done);
  void close();

 private:
  struct State;
  explicit TlsServer(std::shared_ptr<State> state);
  std::shared_ptr<State> state_;
};

class TlsClient {
 public:
  // `authorities`: a PEM file of those who may sign the bridge's certificate (or that certificate
  // itself); empty: the system's.
  [[nodiscard]] static tl::expected<std::unique_ptr<TlsClient>, std::string> make(
      const std::string& authorities);
  ~TlsClient();

  // As the server's; the certificate must be for `host`.
  void shake_hands(boost::asio::ip::tcp::socket socket, const std::string& host, Duration limit,
                   std::function<void(TlsResult)> done);

 private:
  struct State;
  explicit TlsClient(std::shared_ptr<State> state);
  std::shared_ptr<State> state_;
};

}  // namespace fieldcast
