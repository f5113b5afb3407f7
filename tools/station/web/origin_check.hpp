// Which names of this station a request may be made to, and that a page of the station itself made
// it. The first keeps out pages that have their own name point here (DNS rebinding), the second
// every page of other sites (forged requests, cross-site WebSockets). Pure.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/model/spec.hpp"

namespace fieldcast::web {

class HostList {
 public:
  // Served are the address itself, unless it is that of every interface; localhost, 127.0.0.1 and
  // [::1] with its port; and `names`: "station.plant" with this port or without one,
  // "station.plant:443" just so. `usual_port` is left out by browsers: 80, with TLS 443.
  HostList(const ListenSpec& listen, const std::vector<std::string>& names, bool tls);

  // Whether the header Host ("127.0.0.1:8090") is one of these.
  [[nodiscard]] bool serves(std::string_view host) const;

 private:
  std::vector<std::string> hosts_;  // in small letters
};

// Whether the header Origin names this scheme and the very Host of the same request. "null" does
// not.
[[nodiscard]] bool same_origin(std::string_view origin, std::string_view host, bool tls);

// Whether a text can stand in `hosts`: a name, an IPv4 address or "[v6]", and maybe a port.
[[nodiscard]] bool is_host_name(std::string_view text);

}  // namespace fieldcast::web
