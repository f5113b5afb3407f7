// Hash of the buses, devices and channels, without ports, that a standby group must share. Pure.
#pragma once

#include <string>

#include "bridge/base/file_descriptor.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

[[nodiscard]] std::string common_configuration(const BridgeSpec& spec);

// Identity of a process, with which another process on the same kernel can check whether it still
// runs: "boot/namespace/pid/start". A pid alone is reused, after a reboot or in another container.
[[nodiscard]] std::string own_process_identity();

// Returns true only if that process would be visible to this one and no longer runs.
[[nodiscard]] bool has_ended(const std::string& identity);

// Returns a descriptor that is readable when the process ends; invalid if it is not visible.
[[nodiscard]] FileDescriptor open_process(const std::string& identity);

[[nodiscard]] std::string own_host_name();  // human-readable

}  // namespace fieldcast
