// Which process this is, so that another one under the same kernel can tell whether it still runs:
// "boot/namespace/pid/start". A pid alone comes again, after a reboot or in another container.
#pragma once

#include <string>

#include "bridge/base/file_descriptor.hpp"

namespace fieldcast {

[[nodiscard]] std::string own_process_identity();

// True only if that process ran where this one can see it, and does not run any more.
[[nodiscard]] bool has_ended(const std::string& identity);

// Becomes readable when that process ends. None: it did not run where this one can see it.
[[nodiscard]] FileDescriptor open_process(const std::string& identity);

[[nodiscard]] std::string own_host_name();  // for people

}  // namespace fieldcast
