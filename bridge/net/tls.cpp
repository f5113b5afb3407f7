#include "bridge/net/tls.hpp"

#include <openssl/err.h>

#include <array>
#include <boost/asio/post.hpp>
#include <boost/asio/ssl.hpp>
#include <set>

#include "bridge/base/file_stamp.hpp"
#include "bridge/net/tls_context.hpp"
#include "bridge/net/tls_handshake.hpp"

namespace fieldcast {

namespace asio = boost::asio;
using asio::ip::tcp;

namespace {

using tls::Context;
using tls::Done;
using tls::Fault;
using tls::Secure;

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
  tls::run_handshake(stream, Secure::server, limit,
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

}  // namespace fieldcast
