#include "bridge/dds/transport/join_check.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <ifaddrs.h>

#include <algorithm>
#include <charconv>
#include <memory>

#include "bridge/dds/library/fastdds.hpp"
#include "bridge/dds/library/library.hpp"
#include "bridge/security/authority.hpp"
#include "bridge/security/member_folder.hpp"

namespace fieldcast {

std::string to_text(const JoinRemark& remark) { return remark.of + ": " + remark.text; }

JoinCheck check_joining(const DdsSpec& spec, const std::string& bridge, UtcTime now) {
  JoinCheck check;
  if (const auto fault = server_fault(spec)) check.faults.push_back({"dds", *fault, "interfaces"});
  if (!spec.security) return check;
  if (spec.domain > security::kHighestDomain) {
    check.faults.push_back({"dds",
                            fmt::format("security in domain {}: it is for 0 to {}", spec.domain,
                                        security::kHighestDomain),
                            "domain"});
  }
  if (!spec.discovery_servers.empty()) {
    check.faults.push_back({"dds",
                            "security with a discovery server: Fast DDS 2.9 ends the program with "
                            "it; members find each other by multicast",
                            "security"});
  }
  const security::MemberCheck identity =
      security::check_program(*spec.security, !bridge.empty(), now);
  for (const std::string& line : identity.faults)
    check.faults.push_back({"security", line, "security"});
  for (const std::string& line : identity.warnings)
    check.warnings.push_back({"security", line, "security"});
  const auto member = security::read_member(*spec.security);
  if (member && member->role == security::MemberRole::kBridge && !bridge.empty() &&
      member->name != bridge) {
    check.faults.push_back(
        {"security",
         fmt::format("{} is the identity of bridge {}, and this bridge is named {}: others would "
                     "ignore its claims on buses; name it {}, or fieldcast secure add bridge NAME",
                     *spec.security, member->name, bridge, member->name),
         "security"});
  }
  return check;
}

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
