// fieldcast-port as a service of Windows: a session that begins with the computer.
#pragma once

#include <functional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

namespace fieldcast::port {

// The error is one line. Both need the rights of an administrator.
// `arguments`: the command line of the service, without the program. The account of the service is
// LocalService, which has few rights.
[[nodiscard]] tl::expected<void, std::string> install_service(
    const std::string& name, const std::vector<std::string>& arguments);
// Stops the service and waits up to 30 s for its end.
[[nodiscard]] tl::expected<void, std::string> remove_service(const std::string& name);

// Runs the session for the service manager, which started this process, and returns its exit code.
// Fails if a user started this process. The manager's stop ends the session as Ctrl-C does.
[[nodiscard]] tl::expected<int, std::string> run_service(std::function<int()> session);

}  // namespace fieldcast::port
