#include <openssl/x509.h>

#include <boost/asio/ssl/context.hpp>

#include "bridge/net/tls_context.hpp"
// After the headers of OpenSSL, because it defines some of their names as macros.
#include <wincrypt.h>

namespace fieldcast::tls {

// The root certificates of the user and of this computer.
Done use_system_authorities(Context& context) {
  const HCERTSTORE store = ::CertOpenSystemStoreA(0, "ROOT");
  if (store == nullptr) return Fault("the certificates that Windows trusts cannot be read");
  X509_STORE* const trusted = ::SSL_CTX_get_cert_store(context.native_handle());
  for (PCCERT_CONTEXT found = nullptr;
       (found = ::CertEnumCertificatesInStore(store, found)) != nullptr;) {
    const unsigned char* bytes = found->pbCertEncoded;
    X509* const certificate = ::d2i_X509(nullptr, &bytes, static_cast<long>(found->cbCertEncoded));
    if (certificate == nullptr) continue;
    ::X509_STORE_add_cert(trusted, certificate);
    ::X509_free(certificate);
  }
  ::CertCloseStore(store, 0);
  return {};
}

}  // namespace fieldcast::tls
