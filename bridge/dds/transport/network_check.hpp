// Checks whether participants can find each other by multicast: Fast DDS does not report a group
// that cannot be joined. Not needed with a discovery server. Any thread; never waits or throws.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/model/dds_spec.hpp"

namespace fieldcast {

// Why the interface with this IPv4 address receives no multicast; empty if it does or is unknown.
[[nodiscard]] std::optional<std::string> multicast_fault(const std::string& address);

// A one-line warning with the remedy; not with a discovery server or transports of a profile.
[[nodiscard]] std::optional<std::string> multicast_remark(const DdsSpec& spec);

// A one-line warning for discovery servers of `named` that do not respond; empty if all do.
[[nodiscard]] std::optional<std::string> servers_remark(const std::vector<std::string>& named,
                                                        const std::vector<std::string>& missing);

// Size of the kernel's receive buffer for UDP: it grants at most net.core.rmem_max, without an
// error. Datagrams that do not fit are lost, repeated, and delay later ones. Any thread.

// Bytes for each socket. A datagram needs about 800 bytes there: the usual 200 KiB are full after
// 270 samples, and a bridge of 32 buses publishes larger bursts.
inline constexpr std::uint32_t kReceiveBuffer = 1 << 20;

// Bytes that a socket of this process is granted. `std::nullopt` if that cannot be determined.
[[nodiscard]] std::optional<std::uint32_t> granted_receive_buffer(
    std::uint32_t asked = kReceiveBuffer);

// A one-line warning with the remedy if less was granted than requested. Pure.
[[nodiscard]] std::optional<std::string> receive_buffer_remark(
    std::optional<std::uint32_t> granted, std::uint32_t asked = kReceiveBuffer);

// The warning for this process and configuration. Transports of a profile are not checked.
[[nodiscard]] std::optional<std::string> receive_buffer_remark(const DdsSpec& spec);

}  // namespace fieldcast
