// Whether participants can find each other by multicast, as DDS does unless a discovery server is
// named. Fast DDS says nothing when a group cannot be joined: the bridge runs, and nobody finds it.
// Any thread; nothing of it waits or throws.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/model/spec.hpp"

namespace fieldcast {

// Why a socket of this process gets no multicast on the interface with this IPv4 address; nothing:
// it gets it, or no interface has the address.
[[nodiscard]] std::optional<std::string> multicast_fault(const std::string& address);

// What is to be told of this process in the domain: one line with the remedy. With a discovery
// server multicast is not needed; a profile's transports are the user's business.
[[nodiscard]] std::optional<std::string> multicast_remark(const DdsSpec& spec);

// The same of discovery servers that do not answer; nothing: none of `named` is `missing`.
[[nodiscard]] std::optional<std::string> servers_remark(const std::vector<std::string>& named,
                                                        const std::vector<std::string>& missing);

}  // namespace fieldcast
