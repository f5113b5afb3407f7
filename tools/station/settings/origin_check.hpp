// Checks Host against DNS rebinding, and Origin against forged requests and WebSockets. Pure.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/model/program_spec.hpp"

namespace fieldcast::web {

class HostList {
 public:
  // Accepts the listen address, unless it is a wildcard, localhost, 127.0.0.1 and [::1] with its
  // port, and `names`: without a port with the listen port or none, with a port only as written.
  // Browsers omit port 80, with TLS 443.
  HostList(const ListenSpec& listen, const std::vector<std::string>& names, bool tls);

  [[nodiscard]] bool serves(std::string_view host) const;

 private:
  std::vector<std::string> hosts_;  // in lower case
};

// Requires this scheme and the Host of the same request. Refuses "null".
[[nodiscard]] bool same_origin(std::string_view origin, std::string_view host, bool tls);

// A name, an IPv4 address or "[v6]", optionally with a port.
[[nodiscard]] bool is_host_name(std::string_view text);

}  // namespace fieldcast::web
