#include "bridge/net/tls_engine.hpp"

#include <fmt/format.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>

#include <array>

#include "bridge/base/check.hpp"
#include "bridge/base/released_by.hpp"
#include "bridge/net/tls_context.hpp"

namespace fieldcast {

struct TlsEngine::State {
  tls::Context context{tls::Context::tls_client};
  std::string server;
  std::unique_ptr<SSL, ReleasedBy<SSL_free>> tls{};
  BIO *received = nullptr, *sending = nullptr;  // owned by `tls`
};

namespace {

// The server refuses an expired certificate without its name.
tls::Done check_validity(const tls::Context& context, const std::string& file) {
  const X509* own = SSL_CTX_get0_certificate(const_cast<tls::Context&>(context).native_handle());
  if (X509_cmp_current_time(X509_get0_notAfter(own)) > 0) return {};
  return tls::Fault(file + ": the certificate has expired");
}

tls::Done use_files(tls::Context& context, const TlsSpec& files) {
  tls::set_rules(context, tls::Suites::kDevices);
  context.set_verify_mode(boost::asio::ssl::verify_peer);
  auto used = tls::use_authorities(context, files.authority);
  // An authority of the file may be the server's certificate itself.
  X509_STORE_set_flags(SSL_CTX_get_cert_store(context.native_handle()), X509_V_FLAG_PARTIAL_CHAIN);
  if (used) used = tls::use_revoked(context, files.revoked);
  if (used && !files.certificate.empty()) {
    used = tls::use_identity(context, files);
    if (used) used = check_validity(context, files.certificate);
  }
  return used;
}

}  // namespace

TlsEngine::TlsEngine(std::unique_ptr<State> state) : state_(std::move(state)) {}
TlsEngine::~TlsEngine() = default;

tl::expected<std::unique_ptr<TlsEngine>, std::string> TlsEngine::make(const TlsSpec& files,
                                                                      const std::string& server) {
  auto state = std::make_unique<State>();
  if (auto used = use_files(state->context, files); !used) return tls::Fault(used.error());
  state->server = server;
  state->tls.reset(SSL_new(state->context.native_handle()));
  state->received = BIO_new(BIO_s_mem());
  state->sending = BIO_new(BIO_s_mem());
  FIELDCAST_CHECK(state->tls && state->received != nullptr && state->sending != nullptr);
  SSL* const tls = state->tls.get();
  SSL_set_bio(tls, state->received, state->sending);
  SSL_set_connect_state(tls);
  // An address is compared with the addresses of the certificate, any other text with its names.
  if (X509_VERIFY_PARAM_set1_ip_asc(SSL_get0_param(tls), server.c_str()) != 1) {
    ERR_clear_error();
    SSL_set_hostflags(tls, X509_CHECK_FLAG_NO_PARTIAL_WILDCARDS);
    FIELDCAST_CHECK(SSL_set1_host(tls, server.c_str()) == 1);
    FIELDCAST_CHECK(SSL_set_tlsext_host_name(tls, server.c_str()) == 1);
  }
  return std::unique_ptr<TlsEngine>(new TlsEngine(std::move(state)));
}

bool TlsEngine::receive(ByteView bytes, Bytes& plain, Bytes& out) {
  SSL* const tls = state_->tls.get();
  const int size = static_cast<int>(bytes.size());
  FIELDCAST_CHECK(size == 0 || BIO_write(state_->received, bytes.data(), size) == size);
  std::array<std::uint8_t, 4096> buffer;
  bool open = true;
  if (!ready()) {
    ERR_clear_error();
    open = goes_on(SSL_do_handshake(tls));
  }
  for (int count = 1; open && ready() && count > 0;) {
    ERR_clear_error();
    count = SSL_read(tls, buffer.data(), static_cast<int>(buffer.size()));
    if (count > 0)
      plain.insert(plain.end(), buffer.begin(), buffer.begin() + count);
    else
      open = goes_on(count);
  }
  drain(out);
  return open;
}

void TlsEngine::send(ByteView plain, Bytes& out) {
  ERR_clear_error();
  if (!plain.empty() && fault_.empty())
    (void)SSL_write(state_->tls.get(), plain.data(), static_cast<int>(plain.size()));
  drain(out);
}

bool TlsEngine::ready() const { return SSL_is_init_finished(state_->tls.get()) == 1; }

bool TlsEngine::goes_on(int result) {
  switch (SSL_get_error(state_->tls.get(), result)) {
    case SSL_ERROR_NONE:
    case SSL_ERROR_WANT_READ:
    case SSL_ERROR_WANT_WRITE: return true;
    case SSL_ERROR_ZERO_RETURN: fault_ = "closed by the peer"; return false;
    default: fault_ = reason(); return false;
  }
}

std::string TlsEngine::reason() const {
  const long verified = SSL_get_verify_result(state_->tls.get());
  if (verified != X509_V_OK)
    return fmt::format("TLS: the certificate of the server for '{}' is refused: {}", state_->server,
                       X509_verify_cert_error_string(verified));
  const unsigned long code = ERR_peek_error();
  const char* const known = ERR_reason_error_string(code);
  const std::string text = known != nullptr ? known : "protocol error";
  if (ERR_GET_REASON(code) >= SSL_AD_REASON_OFFSET)
    return "TLS: the server refuses this client: " + text;
  if (ERR_GET_REASON(code) == SSL_R_WRONG_VERSION_NUMBER)
    return "TLS: the server does not speak TLS: " + text;
  return "TLS: " + text;
}

void TlsEngine::drain(Bytes& out) {
  char* bytes = nullptr;
  const long size = BIO_get_mem_data(state_->sending, &bytes);
  out.insert(out.end(), bytes, bytes + size);
  (void)BIO_reset(state_->sending);
}

}  // namespace fieldcast
