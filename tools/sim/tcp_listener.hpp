// Accepts TCP masters on this machine only.
#pragma once

#include <cstdint>
#include <string>
#include <tl/expected.hpp>

#include "bridge/base/file_descriptor.hpp"

namespace fieldcast::sim {

// Returns the configured address if it is in 127.0.0.0/8, else 127.0.0.1: the simulator never
// listens on a plant's real address.
[[nodiscard]] std::string loopback_for(const std::string& host);

// Opens a non-blocking listener; the error is human-readable.
[[nodiscard]] tl::expected<FileDescriptor, std::string> listen_on(const std::string& loopback,
                                                                  std::uint16_t port);

// Returns the next connection, non-blocking and with TCP_NODELAY; an empty FileDescriptor if none
// waits.
[[nodiscard]] FileDescriptor accept_from(int listener);

}  // namespace fieldcast::sim
