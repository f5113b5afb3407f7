// A blocking TLS client with timeouts: for tests that simulate a module or an engineer.
#pragma once

#include <openssl/err.h>
#include <openssl/ssl.h>
#include <sys/time.h>

#include <csignal>
#include <memory>

#include "tests/bridge/support/tcp_client.hpp"

namespace fieldcast::test {

class SecureClient {
 public:
  // `identity`: NAME of NAME.pem and NAME.key, or empty. Accepts any server certificate.
  SecureClient(std::uint16_t port, const std::string& identity)
      : context_(SSL_CTX_new(TLS_client_method()), &SSL_CTX_free),
        tcp_(port),
        tls_(SSL_new(context_.get()), &SSL_free) {
    if (!identity.empty()) {
      EXPECT_EQ(SSL_use_certificate_chain_file(tls_.get(), (identity + ".pem").c_str()), 1);
      EXPECT_EQ(SSL_use_PrivateKey_file(tls_.get(), (identity + ".key").c_str(), SSL_FILETYPE_PEM),
                1);
    }
    std::signal(SIGPIPE, SIG_IGN);  // OpenSSL may write to a closed connection
    const timeval limit{10, 0};
    ::setsockopt(tcp_.fd(), SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    SSL_set_fd(tls_.get(), tcp_.fd());
    connected_ = SSL_connect(tls_.get()) == 1;
  }

  void send(std::string_view text) {
    if (connected_) (void)SSL_write(tls_.get(), text.data(), static_cast<int>(text.size()));
  }
  // Returns the data up to and including `end`, or what arrived until the close.
  [[nodiscard]] std::string receive(std::string_view end) {
    char c = 0;
    std::string text;
    while (connected_ && !text.ends_with(end)) {
      if (SSL_read(tls_.get(), &c, 1) != 1) {
        connected_ = false;
        break;
      }
      text += c;
    }
    return text;
  }
  [[nodiscard]] bool is_closed() {
    (void)receive("\n\n\n");
    return !connected_;
  }

 private:
  std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)> context_;
  TcpClient tcp_;
  std::unique_ptr<SSL, decltype(&SSL_free)> tls_;
  bool connected_ = false;
};

}  // namespace fieldcast::test
