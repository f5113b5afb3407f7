// Checks the DDS configuration of a program before it joins its domain. Any thread.
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
// `bridge`: name of the bridge, which needs the identity of that name: others ignore its claims
// otherwise. Empty for other programs, which need an identity of another role.
[[nodiscard]] JoinCheck check_joining(const DdsSpec& spec, const std::string& bridge, UtcTime now);

// Discovery servers, "host:port", and addresses that make Fast DDS abort. Any thread.
struct ServerAddress {
  std::string name;
  std::string address;  // IPv4
  std::uint16_t port = 0;
};

// Uses the system resolver. Throws DdsError for other texts or without an address.
[[nodiscard]] ServerAddress server_address(const std::string& text);

// The IPv4 addresses of this machine's interfaces; `std::nullopt` if they cannot be read.
[[nodiscard]] std::optional<std::vector<std::string>> own_addresses();

// Returns a message with the remedy for the first server of this machine whose address is not in
// `interfaces`: Fast DDS 2.9.1 asserts that it has a sender for it
// (OutputTrafficManager::set_statistics_submessage). Loopback addresses are always allowed. Pure.
[[nodiscard]] std::optional<std::string> server_fault(const std::vector<ServerAddress>& servers,
                                                      const std::vector<std::string>& own,
                                                      const std::vector<std::string>& interfaces);

// For a configuration on this machine now. Skips unknown names and transports of a profile.
[[nodiscard]] std::optional<std::string> server_fault(const DdsSpec& spec);

}  // namespace fieldcast
