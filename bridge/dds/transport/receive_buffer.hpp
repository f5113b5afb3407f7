// Size of the kernel's receive buffer for UDP. Domain requests kReceiveBuffer; the kernel grants at
// most net.core.rmem_max, without an error. Datagrams that do not fit are lost and repeated, and
// delay later ones. Any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/model/dds_spec.hpp"

namespace fieldcast {

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
