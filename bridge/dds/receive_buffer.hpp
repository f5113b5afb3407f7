// How much the kernel holds of what comes by UDP until it is read. Domain asks for kReceiveBuffer;
// the kernel gives no more than net.core.rmem_max and says nothing. What does not fit is lost, sent
// again, and holds up what came after it. Any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/model/spec.hpp"

namespace fieldcast {

// Bytes for each socket. A datagram costs about 800 there: the usual 200 KiB are full after 270
// samples, and a bridge of 32 buses publishes bursts beyond that.
inline constexpr std::uint32_t kReceiveBuffer = 1 << 20;

// What a socket of this process gets of so many bytes. Nothing: it cannot be found out.
[[nodiscard]] std::optional<std::uint32_t> granted_receive_buffer(
    std::uint32_t asked = kReceiveBuffer);

// What is to be told where less was granted than asked: one line with the remedy. Pure.
[[nodiscard]] std::optional<std::string> receive_buffer_remark(
    std::optional<std::uint32_t> granted, std::uint32_t asked = kReceiveBuffer);

// The same for this process in the domain. A profile's transports are the user's business.
[[nodiscard]] std::optional<std::string> receive_buffer_remark(const DdsSpec& spec);

}  // namespace fieldcast
