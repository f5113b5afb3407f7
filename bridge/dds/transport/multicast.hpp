// Checks whether participants can find each other by multicast, which DDS uses unless a discovery
// server is configured. Fast DDS does not report a group that cannot be joined: the bridge runs,
// but is not found. Any thread; the functions do not wait or throw.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/model/dds_spec.hpp"

namespace fieldcast {

// Reason why a socket of this process receives no multicast on the interface with this IPv4
// address. `std::nullopt` if it does, or if no interface has the address.
[[nodiscard]] std::optional<std::string> multicast_fault(const std::string& address);

// A one-line warning for this process, with the remedy. Multicast is not needed with a discovery
// server; transports of a profile are not checked.
[[nodiscard]] std::optional<std::string> multicast_remark(const DdsSpec& spec);

// A one-line warning for discovery servers that do not respond; `std::nullopt` if none of `named`
// is `missing`.
[[nodiscard]] std::optional<std::string> servers_remark(const std::vector<std::string>& named,
                                                        const std::vector<std::string>& missing);

}  // namespace fieldcast
