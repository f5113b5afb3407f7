#include "bridge/net/tls_handshake.hpp"

#include <algorithm>
#include <boost/asio/ssl.hpp>
#include <boost/asio/steady_timer.hpp>
#include <string>

namespace fieldcast::tls {

namespace asio = boost::asio;
using asio::ip::tcp;

namespace {

// Common name of the peer's verified certificate. Empty unless exactly one that is printable.
std::string common_name_of(const SSL* tls) {
  const std::unique_ptr<X509, decltype(&X509_free)> shown(SSL_get1_peer_certificate(tls),
                                                          &X509_free);
  if (!shown || SSL_get_verify_result(tls) != X509_V_OK) return {};
  const X509_NAME* subject = X509_get_subject_name(shown.get());
  const int at = X509_NAME_get_index_by_NID(subject, NID_commonName, -1);
  if (at < 0 || X509_NAME_get_index_by_NID(subject, NID_commonName, at) >= 0) return {};
  unsigned char* text = nullptr;
  const int size =
      ASN1_STRING_to_UTF8(&text, X509_NAME_ENTRY_get_data(X509_NAME_get_entry(subject, at)));
  if (size < 0) return {};
  const std::string name(reinterpret_cast<const char*>(text), static_cast<std::size_t>(size));
  OPENSSL_free(text);
  const bool plain = std::ranges::all_of(name, [](char c) { return c > ' ' && c <= '~'; });
  return plain ? name : std::string{};
}

class TlsStream final : public ByteStream {
 public:
  explicit TlsStream(std::shared_ptr<Secure> stream) : stream_(std::move(stream)) {}
  void read_some(asio::mutable_buffer into, Done done) override {
    stream_->async_read_some(into, [stream = stream_, done = std::move(done)](
                                       boost::system::error_code fault, std::size_t count) {
      // Many peers disconnect without a close_notify, so this is a normal end.
      if (fault == asio::ssl::error::stream_truncated) fault = asio::error::eof;
      done(fault, count);
    });
  }
  void write_some(asio::const_buffer from, Done done) override {
    stream_->async_write_some(
        from, [stream = stream_, done = std::move(done)](
                  boost::system::error_code fault, std::size_t count) { done(fault, count); });
  }
  std::size_t queued() const override {
    return queued_at(static_cast<int>(stream_->next_layer().native_handle()));
  }
  void end_sending() override {
    boost::system::error_code ignored;
    stream_->next_layer().shutdown(tcp::socket::shutdown_send, ignored);
  }
  void close() override {
    boost::system::error_code ignored;
    stream_->next_layer().close(ignored);
  }
  std::string peer_name() const override { return common_name_of(stream_->native_handle()); }

 private:
  std::shared_ptr<Secure> stream_;  // shared with pending operations
};

}  // namespace

void run_handshake(const std::shared_ptr<Secure>& stream,
                   asio::ssl::stream_base::handshake_type side, Duration limit,
                   std::function<void(TlsResult)> done) {
  const auto timer = std::make_shared<asio::steady_timer>(stream->get_executor(), limit);
  const auto late = std::make_shared<bool>(false);
  timer->async_wait([stream, late](boost::system::error_code cancelled) {
    if (cancelled) return;
    *late = true;
    boost::system::error_code ignored;
    stream->next_layer().close(ignored);
  });
  stream->async_handshake(
      side, [stream, timer, late, done = std::move(done)](boost::system::error_code fault) {
        timer->cancel();
        if (*late) return done(tl::make_unexpected(std::string("no TLS handshake in time")));
        if (fault) return done(tl::make_unexpected("TLS handshake: " + fault.message()));
        done(std::make_unique<TlsStream>(stream));
      });
}

}  // namespace fieldcast::tls
