#include "tools/forward/settings/server_address.hpp"

#include "config/document/scalars.hpp"
#include "config/sections/port_text.hpp"

namespace fieldcast::forward {

tl::expected<ServerAddress, std::string> server_address_from(std::string_view text,
                                                             const AddressSchemes& schemes) {
  ServerAddress address;
  address.tls = text.starts_with(schemes.tls);
  if (text.find('@') != text.npos)
    return tl::make_unexpected(
        "a server with a login in its address; the login belongs to the keys of this section, for "
        "example user and password-file");
  if (!address.tls && !text.starts_with(schemes.plain))
    return tl::make_unexpected("server '" + std::string(text) + "' does not begin with " +
                               std::string(schemes.plain) + " or " + std::string(schemes.tls));
  const auto host_port = config::host_port_from(
      std::string(text.substr(address.tls ? schemes.tls.size() : schemes.plain.size())));
  if (!host_port)
    return tl::make_unexpected("server '" + std::string(text) + "' names no host and port");
  address.host = host_port->first;
  address.port = host_port->second;
  address.on_loopback = is_loopback(address.host);
  return address;
}

bool is_loopback(const std::string& host) {
  return host == "localhost" || host == "::1" ||
         (host.starts_with("127.") && config::is_ipv4(host));
}

}  // namespace fieldcast::forward
