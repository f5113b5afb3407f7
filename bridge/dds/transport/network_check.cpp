#include "bridge/dds/transport/network_check.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <memory>

#include "bridge/base/file_descriptor.hpp"
#include "bridge/dds/transport/domain.hpp"

namespace fieldcast {

namespace {

constexpr const char* kGroup = "239.255.0.1";  // of every domain (RTPS 2.2, 9.6.1.4.1)

// The IFF_.. flags of the interface with the address; `std::nullopt` if there is none.
std::optional<unsigned> flags_of(const in_addr& address) {
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) return std::nullopt;
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(list, freeifaddrs);
  for (const ifaddrs* one = list; one != nullptr; one = one->ifa_next) {
    if (one->ifa_addr == nullptr || one->ifa_addr->sa_family != AF_INET) continue;
    if (reinterpret_cast<const sockaddr_in*>(one->ifa_addr)->sin_addr.s_addr == address.s_addr)
      return one->ifa_flags;
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> multicast_fault(const std::string& address) {
  ip_mreq membership{};
  inet_pton(AF_INET, kGroup, &membership.imr_multiaddr);
  if (inet_pton(AF_INET, address.c_str(), &membership.imr_interface) != 1) return std::nullopt;
  const auto flags = flags_of(membership.imr_interface);
  if (!flags) return std::nullopt;
  // The loopback has multicast without the flag.
  if ((*flags & (IFF_MULTICAST | IFF_LOOPBACK)) == 0) return "its interface has it switched off";
  const FileDescriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (setsockopt(socket.get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership) != 0)
    return errno_text(errno);
  return std::nullopt;
}

std::optional<std::string> multicast_remark(const DdsSpec& spec) {
  if (spec.profile || !spec.discovery_servers.empty()) return std::nullopt;
  for (const std::string& address : used_interfaces(spec)) {
    if (const auto fault = multicast_fault(address)) {
      return fmt::format(
          "no multicast on {} ({}): bridges and stations do not find each other there; remedy: "
          "discovery-server: HOST:PORT below dds: of every participant",
          address, *fault);
    }
  }
  return std::nullopt;
}

std::optional<std::string> servers_remark(const std::vector<std::string>& named,
                                          const std::vector<std::string>& missing) {
  if (missing.empty()) return std::nullopt;
  std::string text;
  for (const std::string& server : missing) {
    const auto identity = std::find(named.begin(), named.end(), server) - named.begin();
    text += fmt::format("{}{} (fast-discovery-server -i {})", text.empty() ? "" : ", ", server,
                        identity);
  }
  return fmt::format("no response of the discovery server {}: {}", text,
                     missing.size() < named.size()
                         ? "participants find each other by the others as long as those run"
                         : "participants do not find each other until one runs");
}

std::optional<std::uint32_t> granted_receive_buffer(std::uint32_t asked) {
  const FileDescriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  const int wanted = static_cast<int>(asked);
  int granted = 0;
  socklen_t size = sizeof granted;
  if (setsockopt(socket.get(), SOL_SOCKET, SO_RCVBUF, &wanted, sizeof wanted) != 0 ||
      getsockopt(socket.get(), SOL_SOCKET, SO_RCVBUF, &granted, &size) != 0)
    return std::nullopt;
  return static_cast<std::uint32_t>(granted) / 2;  // Linux uses the other half for its own overhead
}

std::optional<std::string> receive_buffer_remark(std::optional<std::uint32_t> granted,
                                                 std::uint32_t asked) {
  if (!granted || *granted >= asked) return std::nullopt;
  return fmt::format(
      "the kernel holds {} KiB of what comes by UDP where {} KiB were asked for: bursts of many "
      "channels get lost and are sent again; remedy: sysctl -w net.core.rmem_max={}",
      *granted / 1024, asked / 1024, asked);
}

std::optional<std::string> receive_buffer_remark(const DdsSpec& spec) {
  if (spec.profile) return std::nullopt;
  return receive_buffer_remark(granted_receive_buffer());
}

}  // namespace fieldcast
