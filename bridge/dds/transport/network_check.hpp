// Checks whether participants can find each other by multicast, which DDS uses unless a discovery
// server is configured. Fast DDS does not report a group that cannot be joined: the bridge runs,
// but is not found. Any thread; the functions do not wait or throw.
#pragma once

#include <cstdint>
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

// Size of the kernel's receive buffer for UDP. Domain requests kReceiveBuffer; the kernel grants at
// most net.core.rmem_max, without an error. Datagrams that do not fit are lost and repeated, and
// delay later ones. Any thread.

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
