#include "tools/forward/settings/http_keys.hpp"

#include <fmt/format.h>

#include "config/sections/port_text.hpp"
#include "tools/forward/settings/login_keys.hpp"
#include "tools/forward/settings/server_address.hpp"

namespace fieldcast::forward {

namespace {

void check_server(config::MapReader& map, const HttpSpec& spec) {
  constexpr std::string_view kForm = "http://HOST:PORT or https://HOST:PORT";
  constexpr std::string_view kPlain = "http://", kTls = "https://";
  const bool is_tls = spec.server.starts_with(kTls);
  if (spec.server.find('@') != std::string::npos) {
    map.fault("server",
              "a server with a login in its address; the login belongs to user and "
              "password-file, or token-file");
    return;
  }
  if (!is_tls && !spec.server.starts_with(kPlain)) {
    map.fault("server",
              fmt::format("server '{}' does not begin with http:// or https://", spec.server),
              kForm);
    return;
  }
  const std::string rest = spec.server.substr(is_tls ? kTls.size() : kPlain.size());
  const auto host_port = config::host_port_from(rest.substr(0, rest.find('/')));
  if (!host_port) {
    map.fault("server", fmt::format("server '{}' names no host and port", spec.server), kForm);
    return;
  }
  if (!is_tls && !spec.without_tls && !is_loopback(host_port->first))
    map.fault("server", fmt::format("server '{}' is off this machine and without TLS", spec.server),
              "https://HOST:PORT, or without-tls: true if the network is trusted");
  if (!is_tls && (!spec.authority.empty() || !spec.certificate.empty()))
    map.fault("server", "'authority' or 'certificate' without a server https://HOST:PORT",
              "https://HOST:PORT");
}

}  // namespace

void read_http(config::MapReader& map, config::Library& library, HttpSpec& spec) {
  read_files(map, library,
             {{"authority", &spec.authority},
              {"certificate", &spec.certificate},
              {"key", &spec.key},
              {"password-file", &spec.password_file},
              {"token-file", &spec.token_file}});
  while (spec.server.ends_with('/')) spec.server.pop_back();
  check_server(map, spec);
  check_pair(map, "certificate", spec.certificate, "key", spec.key, "both, as PEM files");
  check_pair(map, "user", spec.user, "password-file", spec.password_file, "both");
  if (!spec.user.empty() && !spec.token_file.empty())
    map.fault("token-file", "more than one login", "one of: user with password-file, token-file");
}

}  // namespace fieldcast::forward
