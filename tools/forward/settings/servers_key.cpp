#include "tools/forward/settings/servers_key.hpp"

#include <fmt/format.h>

#include "config/document/scalars.hpp"
#include "tools/forward/settings/server_address.hpp"

namespace fieldcast::forward {

namespace {

constexpr std::size_t kMostServers = 16;

}  // namespace

void read_servers(config::MapReader& map, std::string_view scheme, bool without_tls,
                  std::vector<std::string>& servers) {
  const config::Node* node = map.find("servers");
  if (node == nullptr) return;
  const std::string plain = std::string(scheme) + "://";
  const AddressSchemes schemes{plain, "tls://"};
  const std::string form = fmt::format("{}://HOST:PORT or tls://HOST:PORT", scheme);
  if (!config::is_list(*node, "servers", 1, kMostServers,
                       fmt::format("a list of 1 to {}, each {}", kMostServers, form), map.faults(),
                       config::as_list(*node)))
    return;
  servers.clear();
  for (const config::Node* item : node->items) {
    const std::string* text = config::scalar_of(*item, "server", form, map.faults());
    if (text == nullptr) continue;
    const auto address = server_address_from(*text, schemes);
    if (!address) {
      map.faults().add(item->position, address.error(), form);
      continue;
    }
    if (!address->tls && !address->on_loopback && !without_tls) {
      map.faults().add(item->position,
                       fmt::format("server '{}' is off this machine and without TLS", *text),
                       "tls://HOST:PORT, or without-tls: true if the network is trusted",
                       "tls" + text->substr(text->find("://")));
    }
    servers.push_back(*text);
  }
}

}  // namespace fieldcast::forward
