// Files of TLS. Plain value.
#pragma once

#include <string>

namespace fieldcast {

// All are paths of PEM files.
struct TlsSpec {
  // Of the bridge. A listening port uses TLS if they are set.
  std::string certificate, key;
  // Issuer of the peer's certificate. Empty at a listening port: clients need none.
  std::string authority;
  std::string revoked;  // certificate revocation list; empty: none
  friend bool operator==(const TlsSpec&, const TlsSpec&) = default;
};

}  // namespace fieldcast
