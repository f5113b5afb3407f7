// TLS, both ends (OpenSSL). Lives on one io thread. TLS 1.3, and TLS 1.2 with
// ECDHE and AEAD suites only. A server may ask for the certificates of its clients;
// ByteStream::peer_name() then tells who a client is.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <tl/expected.hpp>

#include "bridge/net/byte_stream.hpp"
#include "core/base/time.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

// Else why not, in one line.
using TlsResult = tl::expected<std::unique_ptr<ByteStream>, std::string>;

class TlsServer {
 public:
  // Whether a client shows a certificate that the authority signed.
  enum class Clients : std::uint8_t { kMay, kMust };

  // PEM files. The error names the file: there is none, it holds something else, the key is open to
  // others. Without an authority clients show no certificate.
  //
  // With an authority, files that change are read again before the next connection, so that a
  // certificate can be renewed and another one revoked while the server runs. While one of them is
  // of no use, nobody is let in.
  [[nodiscard]] static tl::expected<std::unique_ptr<TlsServer>, std::string> make(
      const TlsSpec& files, Clients clients = Clients::kMust);
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
  // itself); empty: the system's. `own`: what this client shows of itself, if it has a certificate.
  [[nodiscard]] static tl::expected<std::unique_ptr<TlsClient>, std::string> make(
      const std::string& authorities, const TlsSpec& own = {});
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
