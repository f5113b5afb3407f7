#include "bridge/net/tls.hpp"

#include <fmt/format.h>
#include <openssl/err.h>

#include <algorithm>
#include <array>
#include <boost/asio/post.hpp>
#include <boost/asio/ssl.hpp>
#include <boost/asio/ssl/host_name_verification.hpp>
#include <boost/asio/steady_timer.hpp>
#include <set>

#include "bridge/base/file_descriptor.hpp"
#include "bridge/net/tls_context.hpp"

namespace fieldcast {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using Secure = asio::ssl::stream<tcp::socket>;

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
  std::size_t queued() const override { return queued_at(stream_->next_layer().native_handle()); }
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

namespace {

using tls::Context;
using tls::Done;
using tls::Fault;

Done use_authority(Context& context, const TlsSpec& files, TlsServer::Clients clients) {
  if (auto used = tls::use_authorities(context, files.authority); !used) return used;
  context.set_verify_mode(clients == TlsServer::Clients::kMust
                              ? asio::ssl::verify_peer | asio::ssl::verify_fail_if_no_peer_cert
                              : asio::ssl::verify_peer);
  // Only certificates signed directly by an authority of the file are accepted. The owner of a
  // certificate that by mistake may sign others cannot create more for this bridge.
  SSL_CTX_set_verify_depth(context.native_handle(), 0);
  X509_STORE_set_flags(SSL_CTX_get_cert_store(context.native_handle()), X509_V_FLAG_PARTIAL_CHAIN);
  // No session resumption: a resumed session would skip the revocation list.
  SSL_CTX_set_session_cache_mode(context.native_handle(), SSL_SESS_CACHE_OFF);
  SSL_CTX_set_options(context.native_handle(), SSL_OP_NO_TICKET);
  SSL_CTX_set_num_tickets(context.native_handle(), 0);
  return tls::use_revoked(context, files.revoked);
}

using Stamps = std::array<FileStamp, 4>;

Stamps stamps_of(const TlsSpec& files) {
  return {FileStamp::of(files.certificate), FileStamp::of(files.key),
          FileStamp::of(files.authority), FileStamp::of(files.revoked)};
}

}  // namespace

struct TlsServer::State {
  TlsSpec files;
  Clients clients = Clients::kMust;
  Stamps stamps;
  std::unique_ptr<Context> context;  // null: a file is not usable now
  std::string trouble;               // if so: which file and why
  std::set<std::shared_ptr<Secure>> shaking;
  bool closed = false;

  void load() {
    stamps = stamps_of(files);
    auto made = std::make_unique<Context>(Context::tls_server);
    tls::set_rules(*made);
    auto loaded = tls::use_identity(*made, files);
    if (loaded && !files.authority.empty()) loaded = use_authority(*made, files, clients);
    context = loaded ? std::move(made) : nullptr;
    trouble = loaded ? "" : loaded.error();
  }
};

TlsServer::TlsServer(std::shared_ptr<State> state) : state_(std::move(state)) {}
TlsServer::~TlsServer() { close(); }

tl::expected<std::unique_ptr<TlsServer>, std::string> TlsServer::make(const TlsSpec& files,
                                                                      Clients clients) {
  auto state = std::make_shared<State>();
  state->files = files;
  state->clients = clients;
  state->load();
  if (!state->context) return Fault(state->trouble);
  return std::unique_ptr<TlsServer>(new TlsServer(std::move(state)));
}

std::function<void()> TlsServer::shake_hands(tcp::socket socket, Duration limit,
                                             std::function<void(TlsResult)> done) {
  if (!state_->files.authority.empty() && stamps_of(state_->files) != state_->stamps)
    state_->load();
  if (!state_->context) {
    asio::post(socket.get_executor(), [state = state_, done = std::move(done)] {
      if (!state->closed) done(Fault(state->trouble));
    });
    return [] {};
  }
  const auto stream = std::make_shared<Secure>(std::move(socket), *state_->context);
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
    const std::string& authorities, const TlsSpec& own) {
  auto state = std::make_shared<State>();
  tls::set_rules(state->context);
  auto used = tls::use_authorities(state->context, authorities);
  state->context.set_verify_mode(asio::ssl::verify_peer);
  if (used && !own.certificate.empty()) used = tls::use_identity(state->context, own);
  if (!used) return Fault(used.error());
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
