// One master on a line: the exclusive lock of a serial device, and who holds it when it is not
// ours.
#pragma once

#include <optional>
#include <string>

namespace fieldcast {

// Takes flock(LOCK_EX) and TIOCEXCL on the open device. Nothing on success, else one line naming
// the holder if /proc tells: "in use by mbpoll (process 1234)". The lock ends with the descriptor.
[[nodiscard]] std::optional<std::string> lock_port(int fd, const std::string& path);

// Some process that has the device open, or that holds a lock on it: "mbpoll (process 1234)"; empty
// if none can be seen (processes of other users cannot).
[[nodiscard]] std::string port_user(const std::string& path);

}  // namespace fieldcast
