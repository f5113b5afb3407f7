#include "tools/forward/settings/server_address.hpp"

#include "config/document/scalars.hpp"
#include "config/sections/port_text.hpp"

namespace fieldcast::forward {

tl::expected<ServerAddress, std::string> server_address_from(std::string_view text) {
  constexpr std::string_view kTls = "tls://", kPlain = "nats://";
  ServerAddress address;
  address.tls = text.starts_with(kTls);
  if (text.find('@') != text.npos)
    return tl::make_unexpected(
        "a server with a login in its address; the login belongs to user and password-file, "
        "token-file or credentials");
  if (!address.tls && !text.starts_with(kPlain))
    return tl::make_unexpected("server '" + std::string(text) +
                               "' does not begin with nats:// or "
                               "tls://");
  const auto host_port =
      config::host_port_from(std::string(text.substr(address.tls ? kTls.size() : kPlain.size())));
  if (!host_port)
    return tl::make_unexpected("server '" + std::string(text) + "' names no host and port");
  address.on_loopback = is_loopback(host_port->first);
  return address;
}

bool is_loopback(const std::string& host) {
  return host == "localhost" || host == "::1" ||
         (host.starts_with("127.") && config::is_ipv4(host));
}

}  // namespace fieldcast::forward
