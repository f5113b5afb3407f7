// The key `servers` of engines whose addresses are URLs.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "config/document/map_reader.hpp"

namespace fieldcast::forward {

// `scheme`: of plain text, as "nats"; with TLS it is "tls". Without the key, `servers` stays.
void read_servers(config::MapReader& map, std::string_view scheme, bool without_tls,
                  std::vector<std::string>& servers);

}  // namespace fieldcast::forward
