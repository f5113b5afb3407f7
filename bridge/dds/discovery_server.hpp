// A discovery server as a configuration names it, "host:port", and which of them Fast DDS cannot
// stand. Any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/model/spec.hpp"

namespace fieldcast {

struct ServerAddress {
  std::string name;     // as it was given
  std::string address;  // IPv4
  std::uint16_t port = 0;
};

// Asks the resolver of the machine for the address of a name, and may wait for it. Throws DdsError:
// not host:port, or no address is known.
[[nodiscard]] ServerAddress server_address(const std::string& text);

// The IPv4 addresses of this machine's interfaces; nothing: they cannot be known.
[[nodiscard]] std::optional<std::vector<std::string>> own_addresses();

// The first of these servers that has an address of this machine which DDS is not to use, for
// people, with the remedy. Fast DDS 2.9.1 ends the program with it: it takes the address for one
// that it can send from, has no sender for it, and asserts that it has
// (OutputTrafficManager::set_statistics_submessage). The loopback is always used, with all of its
// addresses. Pure.
[[nodiscard]] std::optional<std::string> server_fault(const std::vector<ServerAddress>& servers,
                                                      const std::vector<std::string>& own,
                                                      const std::vector<std::string>& interfaces);

// The same of a configuration, on this machine, now. Names without an address are passed over:
// joining says that. Transports of a user's profile are the user's business.
[[nodiscard]] std::optional<std::string> server_fault(const DdsSpec& spec);

}  // namespace fieldcast
