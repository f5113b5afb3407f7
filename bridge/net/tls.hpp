// TLS server and client (OpenSSL), on one io thread. TLS 1.3; TLS 1.2 only with ECDHE and AEAD. A
// server may request client certificates; ByteStream::peer_name() identifies the client.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <tl/expected.hpp>

#include "bridge/net/byte_stream.hpp"
#include "core/base/time.hpp"
#include "core/model/program_spec.hpp"

namespace fieldcast {

// The error is one line.
using TlsResult = tl::expected<std::unique_ptr<ByteStream>, std::string>;

class TlsServer {
 public:
  // Whether a client may or must present a certificate that the authority signed.
  enum class Clients : std::uint8_t { kMay, kMust };

  // PEM files. Fails with a text that names the file if it is missing, has other contents, or is a
  // key that others can read. With an authority, changed files are read again before the next
  // connection, to renew and revoke certificates; while one is not usable, every connection is
  // refused.
  [[nodiscard]] static tl::expected<std::unique_ptr<TlsServer>, std::string> make(
      const TlsSpec& files, Clients clients = Clients::kMust);
  ~TlsServer();

  // `done` is called once within the limit, never inside this call and not after close(). The
  // returned function aborts a pending handshake.
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
  // `authorities`: PEM file of the authorities of the bridge's certificate, or that certificate;
  // empty: those of the system. `own`: this client's certificate, if it has one.
  [[nodiscard]] static tl::expected<std::unique_ptr<TlsClient>, std::string> make(
      const std::string& authorities, const TlsSpec& own = {});
  ~TlsClient();

  // As TlsServer::shake_hands(); the certificate must be for `host`.
  void shake_hands(boost::asio::ip::tcp::socket socket, const std::string& host, Duration limit,
                   std::function<void(TlsResult)> done);

 private:
  struct State;
  explicit TlsClient(std::shared_ptr<State> state);
  std::shared_ptr<State> state_;
};

}  // namespace fieldcast
