// Listening for masters over TCP, on this machine only.
#pragma once

#include <cstdint>
#include <string>
#include <tl/expected.hpp>

#include "bridge/base/file_descriptor.hpp"

namespace fieldcast::sim {

// The configured address if it is one of 127.0.0.0/8, else 127.0.0.1: a plant's real addresses are
// simulated here, never there.
[[nodiscard]] std::string loopback_for(const std::string& host);

// A non-blocking listener, or why not, for people.
[[nodiscard]] tl::expected<FileDescriptor, std::string> listen_on(const std::string& loopback,
                                                                  std::uint16_t port);

// The next connection, non-blocking and without Nagle's delay; an empty FileDescriptor when none
// waits.
[[nodiscard]] FileDescriptor accept_from(int listener);

}  // namespace fieldcast::sim
