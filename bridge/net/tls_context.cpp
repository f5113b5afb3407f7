#include "bridge/net/tls_context.hpp"

#include <fmt/format.h>
#include <openssl/err.h>

#include "bridge/base/check.hpp"
#include "bridge/process/secret.hpp"

namespace fieldcast::tls {
namespace {

constexpr const char* kStrictSuites = "ECDHE+AESGCM:ECDHE+CHACHA20";
// In this order: the last ones have no ephemeral keys, or no authenticated encryption.
constexpr const char* kDeviceSuites =
    "ECDHE+AESGCM:ECDHE+CHACHA20:ECDHE+AES:kRSA+AESGCM:AES128-SHA256:AES256-SHA256";

Fault fault_of(const std::string& file, const char* what, const boost::system::error_code& why) {
  return Fault(fmt::format("{}: {}: {}", file, what, why.message()));
}

}  // namespace

void set_rules(Context& context, Suites suites) {
  context.set_options(Context::default_workarounds | Context::no_sslv2 | Context::no_sslv3 |
                      Context::no_tlsv1 | Context::no_tlsv1_1 | Context::no_compression);
  SSL_CTX* const native = context.native_handle();
  FIELDCAST_CHECK(SSL_CTX_set_min_proto_version(native, TLS1_2_VERSION) == 1);
  const char* const list = suites == Suites::kDevices ? kDeviceSuites : kStrictSuites;
  FIELDCAST_CHECK(SSL_CTX_set_cipher_list(native, list) == 1);
  SSL_CTX_set_options(native, SSL_OP_NO_RENEGOTIATION);
}

Done use_authorities(Context& context, const std::string& authorities) {
  if (authorities.empty()) return use_system_authorities(context);
  boost::system::error_code fault;
  context.load_verify_file(authorities, fault);
  if (fault) return fault_of(authorities, "no certificates in PEM form", fault);
  return {};
}

Done use_identity(Context& context, const TlsSpec& files) {
  boost::system::error_code fault;
  context.use_certificate_chain_file(files.certificate, fault);
  if (fault) return fault_of(files.certificate, "no certificate in PEM form", fault);
  if (auto closed = check_secret_file(files.key, Readers::kOwnerAndGroup); !closed) return closed;
  context.use_private_key_file(files.key, Context::pem, fault);
  if (fault)
    return fault_of(files.key, "no private key in PEM form, or not the certificate's", fault);
  return {};
}

Done use_revoked(Context& context, const std::string& revoked) {
  if (revoked.empty()) return {};
  X509_STORE* store = SSL_CTX_get_cert_store(context.native_handle());
  X509_LOOKUP* lookup = X509_STORE_add_lookup(store, X509_LOOKUP_file());
  if (lookup == nullptr || X509_load_crl_file(lookup, revoked.c_str(), X509_FILETYPE_PEM) < 1) {
    ERR_clear_error();
    return Fault(revoked + ": no list of revoked certificates (CRL) in PEM form");
  }
  X509_STORE_set_flags(store, X509_V_FLAG_CRL_CHECK);
  return {};
}

}  // namespace fieldcast::tls
