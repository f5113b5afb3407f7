#include <boost/asio/ssl.hpp>
#include <boost/asio/ssl/host_name_verification.hpp>

#include "bridge/net/tls_context.hpp"
#include "bridge/net/tls_handshake.hpp"

namespace fieldcast {

namespace asio = boost::asio;
using asio::ip::tcp;

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
  if (!used) return tls::Fault(used.error());
  return std::unique_ptr<TlsClient>(new TlsClient(std::move(state)));
}

void TlsClient::shake_hands(tcp::socket socket, const std::string& host, Duration limit,
                            std::function<void(TlsResult)> done) {
  const auto stream = std::make_shared<tls::Secure>(std::move(socket), state_->context);
  boost::system::error_code fault;
  stream->set_verify_callback(asio::ssl::host_name_verification(host), fault);
  SSL_set_tlsext_host_name(stream->native_handle(), host.c_str());
  tls::run_handshake(
      stream, tls::Secure::client, limit,
      [state = state_, done = std::move(done)](TlsResult result) { done(std::move(result)); });
}

}  // namespace fieldcast
