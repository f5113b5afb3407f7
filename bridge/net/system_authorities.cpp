#include "bridge/net/tls_context.hpp"

namespace fieldcast::tls {

Done use_system_authorities(Context& context) {
  boost::system::error_code fault;
  context.set_default_verify_paths(fault);
  if (fault) return Fault("the certificates that this system trusts: " + fault.message());
  return {};
}

}  // namespace fieldcast::tls
