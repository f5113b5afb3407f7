#include "bridge/net/tls.hpp"

#include <fmt/format.h>

#include <boost/asio/ssl.hpp>
#include <boost/asio/ssl/host_name_verification.hpp>
#include <boost/asio/steady_timer.hpp>
#include <set>

namespace fieldcast {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using Secure = asio::ssl::stream<tcp::socket>;

class TlsStream final : public ByteStream {
 public:
  explicit TlsStream(std::shared_ptr<Secure> stream) : stream_(std::move(stream)) {}
  void read_some(asio::mutable_buffer into, Done done) override {
    stream_->async_read_some(into, [stream = stream_, done = std::move(done)](
                                       boost::system::error_code fault, std::size_t count) {
      // Peers that leave without a close_notify are the rule.
      if (fault == asio::ssl::error::stream_truncated) fault = asio::error::eof;
      done(fault, count);
    });
  }
  void write_some(asio::const_buffer from, Done done) override {
    stream_->async_write_some(
        from, [stream = stream_, done = std::move(done)](
                  boost::system::error_code fault, std::size_t count) { done(fault, count); });
  }
  std::size_t queued() const override { return queued_at(stream_->next_layer().native_handle()); }
  void end_sending() override {
    boost::system::error_code ignored;
    stream_->next_layer().shutdown(tcp::socket::shutdown_send, ignored);
  }
  void close() override {
    boost::system::error_code ignored;
    stream_->next_layer().close(ignored);
  }

 private:
  std::shared_ptr<Secure> stream_;  // shared with the operations under way
};

void set_rules(asio::ssl::context& context) {
  context.set_options(asio::ssl::context::default_workarounds | asio::ssl::context::no_sslv2 |
                      asio::ssl::context::no_sslv3 | asio::ssl::context::no_tlsv1 |
                      asio::ssl::context::no_tlsv1_1);
}

// A handshake with a limit. `keep` lives as long as it does.
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

}  // namespace

struct TlsServer::State {
  asio::ssl::context context{asio::ssl::context::tls_server};
  std::set<std::shared_ptr<Secure>> shaking;
  bool closed = false;
};

TlsServer::TlsServer(std::shared_ptr<State> state) : state_(std::move(state)) {}
TlsServer::~TlsServer() { close(); }

tl::expected<std::unique_ptr<TlsServer>, std::string> TlsServer::make(
    const std::string& certificate, const std::string& key) {
  auto state = std::make_shared<State>();
  set_rules(state->context);
  boost::system::error_code fault;
  state->context.use_certificate_chain_file(certificate, fault);
  if (fault)
    return tl::make_unexpected(
        fmt::format("{}: no certificate in PEM form: {}", certificate, fault.message()));
  state->context.use_private_key_file(key, asio::ssl::context::pem, fault);
  if (fault)
    return tl::make_unexpected(fmt::format(
        "{}: no private key in PEM form, or not the certificate's: {}", key, fault.message()));
  return std::unique_ptr<TlsServer>(new TlsServer(std::move(state)));
}

std::function<void()> TlsServer::shake_hands(tcp::socket socket, Duration limit,
                                             std::function<void(TlsResult)> done) {
  const auto stream = std::make_shared<Secure>(std::move(socket), state_->context);
  state_->shaking.insert(stream);
  run_handshake(stream, Secure::server, limit,
                [state = state_, stream, done = std::move(done)](TlsResult result) {
                  state->shaking.erase(stream);
                  if (!state->closed) done(std::move(result));
                });
  return [weak = std::weak_ptr(stream)] {
    boost::system::error_code ignored;
    if (const auto shaking = weak.lock()) shaking->next_layer().close(ignored);
  };
}

void TlsServer::close() {
  state_->closed = true;
  for (const auto& stream : state_->shaking) {
    boost::system::error_code ignored;
    stream->next_layer().close(ignored);
  }
}

struct TlsClient::State {
  asio::ssl::context context{asio::ssl::context::tls_client};
};

TlsClient::TlsClient(std::shared_ptr<State> state) : state_(std::move(state)) {}
TlsClient::~TlsClient() = default;

tl::expected<std::unique_ptr<TlsClient>, std::string> TlsClient::make(
    const std::string& authorities) {
  auto state = std::make_shared<State>();
  set_rules(state->context);
  boost::system::error_code fault;
  if (authorities.empty()) {
    state->context.set_default_verify_paths(fault);
  } else {
    state->context.load_verify_file(authorities, fault);
  }
  if (fault)
    return tl::make_unexpected(
        fmt::format("{}: no certificates in PEM form: {}", authorities, fault.message()));
  state->context.set_verify_mode(asio::ssl::verify_peer);
  return std::unique_ptr<TlsClient>(new TlsClient(std::move(state)));
}

void TlsClient::shake_hands(tcp::socket socket, const std::string& host, Duration limit,
                            std::function<void(TlsResult)> done) {
  const auto stream = std::make_shared<Secure>(std::move(socket), state_->context);
  boost::system::error_code fault;
  stream->set_verify_callback(asio::ssl::host_name_verification(host), fault);
  SSL_set_tlsext_host_name(stream->native_handle(), host.c_str());
  run_handshake(
      stream, Secure::client, limit,
      [state = state_, done = std::move(done)](TlsResult result) { done(std::move(result)); });
}

}  // namespace fieldcast
