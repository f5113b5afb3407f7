// Checks the DDS configuration of a program before it joins its domain: its identity and settings
// that Fast DDS cannot handle. Used by --check, the start and a reload. Any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/time.hpp"
#include "core/model/dds_spec.hpp"

namespace fieldcast {

struct JoinRemark {
  std::string of;    // "security" or "dds"
  std::string text;  // human-readable, with the remedy
  std::string key;   // of `dds:` in the configuration, to which the remark belongs
};
[[nodiscard]] std::string to_text(const JoinRemark& remark);

struct JoinCheck {
  std::vector<JoinRemark> faults;    // the program cannot join, or other members will refuse it
  std::vector<JoinRemark> warnings;  // other members will soon refuse it
};
// `bridge` is the name of the bridge; empty for other programs. A bridge needs the identity of a
// bridge of its name, because other bridges ignore its claims on buses otherwise
// (bridge_announcement.hpp). All other programs need an identity of another role.
[[nodiscard]] JoinCheck check_joining(const DdsSpec& spec, const std::string& bridge, UtcTime now);

// Parses discovery servers, "host:port", and detects addresses that make Fast DDS abort. Any
// thread.

struct ServerAddress {
  std::string name;
  std::string address;  // IPv4
  std::uint16_t port = 0;
};

// Resolves the name with the system resolver, and may wait for it. Throws DdsError if the text is
// not host:port or no address is found.
[[nodiscard]] ServerAddress server_address(const std::string& text);

// The IPv4 addresses of this machine's interfaces; `std::nullopt` if they cannot be read.
[[nodiscard]] std::optional<std::vector<std::string>> own_addresses();

// Returns a message with the remedy for the first server whose address belongs to this machine but
// is not in `interfaces`. Fast DDS 2.9.1 aborts with such a server: it expects a sender for the
// address and asserts that it has one (OutputTrafficManager::set_statistics_submessage). All
// loopback addresses are always allowed. Pure.
[[nodiscard]] std::optional<std::string> server_fault(const std::vector<ServerAddress>& servers,
                                                      const std::vector<std::string>& own,
                                                      const std::vector<std::string>& interfaces);

// Applies the check to a configuration on this machine now. Skips names without an address, because
// joining reports them. Transports of a user's profile are not checked.
[[nodiscard]] std::optional<std::string> server_fault(const DdsSpec& spec);

}  // namespace fieldcast
