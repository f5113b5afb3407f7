// One master on a line: exclusive lock of a serial device, and its holder if the lock fails.
#pragma once

#include <optional>
#include <string>

namespace fieldcast {

// Locks the open device with flock(LOCK_EX) and TIOCEXCL. Returns `std::nullopt` on success,
// otherwise one line with the holder if /proc shows it: "in use by mbpoll (process 1234)". The lock
// ends with the descriptor.
[[nodiscard]] std::optional<std::string> lock_port(int fd, const std::string& path);

// Returns a process that has the device open or locked: "mbpoll (process 1234)"; empty if none is
// visible (processes of other users are not).
[[nodiscard]] std::string port_user(const std::string& path);

}  // namespace fieldcast
