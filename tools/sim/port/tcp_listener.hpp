// Accepts masters by TCP and UDP on this machine only.
#pragma once

#include <cstdint>
#include <string>
#include <tl/expected.hpp>

#include "bridge/base/file_descriptor.hpp"

namespace fieldcast::sim {

// Returns the address if it is in 127.0.0.0/8, else 127.0.0.1, never a plant's real address.
[[nodiscard]] std::string loopback_for(const std::string& host);

[[nodiscard]] tl::expected<FileDescriptor, std::string> listen_on(const std::string& loopback,
                                                                  std::uint16_t port);

// Bound and non-blocking.
[[nodiscard]] tl::expected<FileDescriptor, std::string> receive_datagrams_on(
    const std::string& loopback, std::uint16_t port);

// Non-blocking, with TCP_NODELAY; an empty FileDescriptor if none waits.
[[nodiscard]] FileDescriptor accept_from(int listener);

}  // namespace fieldcast::sim
