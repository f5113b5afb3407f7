#include "bridge/dds/transport/discovery_server.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <ifaddrs.h>

#include <algorithm>
#include <charconv>
#include <memory>

#include "bridge/dds/library/dds_error.hpp"
#include "bridge/dds/library/fastdds.hpp"

namespace fieldcast {
namespace {

bool has(const std::vector<std::string>& all, const std::string& one) {
  return std::find(all.begin(), all.end(), one) != all.end();
}

}  // namespace

ServerAddress server_address(const std::string& text) {
  const auto colon = text.rfind(':');
  const std::string host = text.substr(0, colon);
  unsigned port = 0;
  const char* end = text.data() + text.size();
  if (colon == std::string::npos ||
      std::from_chars(text.data() + colon + 1, end, port).ptr != end || port == 0 || port > 65535) {
    throw DdsError("dds: discovery server '" + text + "' is not host:port");
  }
  const auto port_number = static_cast<std::uint16_t>(port);
  if (rtps::IPLocator::isIPv4(host)) return {text, host, port_number};
  const auto found = rtps::IPLocator::resolveNameDNS(host);
  if (found.first.empty())
    throw DdsError("dds: discovery server: no address known for '" + host + "'");
  return {text, *found.first.begin(), port_number};
}

std::optional<std::vector<std::string>> own_addresses() {
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) return std::nullopt;
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(list, freeifaddrs);
  std::vector<std::string> own;
  for (const ifaddrs* one = list; one != nullptr; one = one->ifa_next) {
    if (one->ifa_addr == nullptr || one->ifa_addr->sa_family != AF_INET) continue;
    char text[INET_ADDRSTRLEN];
    const auto& address = reinterpret_cast<const sockaddr_in*>(one->ifa_addr)->sin_addr;
    if (inet_ntop(AF_INET, &address, text, sizeof text) != nullptr) own.emplace_back(text);
  }
  return own;
}

std::optional<std::string> server_fault(const std::vector<ServerAddress>& servers,
                                        const std::vector<std::string>& own,
                                        const std::vector<std::string>& interfaces) {
  if (interfaces.empty()) return std::nullopt;  // all interfaces are used
  for (const ServerAddress& server : servers) {
    if (server.address.starts_with("127.") || !has(own, server.address) ||
        has(interfaces, server.address))
      continue;
    return fmt::format(
        "discovery server {}: {} is an address of this machine, and interfaces is [{}]: Fast DDS "
        "2.9 ends the program with it; name {} in interfaces too",
        server.name, server.address, fmt::join(interfaces, ", "), server.address);
  }
  return std::nullopt;
}

std::optional<std::string> server_fault(const DdsSpec& spec) {
  if (spec.profile || spec.discovery_servers.empty()) return std::nullopt;
  std::vector<ServerAddress> servers;
  for (const std::string& text : spec.discovery_servers) {
    try {
      servers.push_back(server_address(text));
    } catch (const DdsError&) { continue; }
  }
  return server_fault(servers, own_addresses().value_or(std::vector<std::string>()),
                      spec.interfaces);
}

}  // namespace fieldcast
