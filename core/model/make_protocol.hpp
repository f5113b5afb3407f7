// The protocol object of a device, built in or declared. Pure; any thread.
#pragma once

#include <memory>

#include "core/model/spec.hpp"

namespace fieldcast {

// `line`: of the device's bus; what a protocol weighs by wire time depends on it. Fails when the
// address or an option is not the protocol's, or no such protocol is built in and none declared
// (the loader has checked all of it).
[[nodiscard]] tl::expected<std::unique_ptr<Protocol>, OptionFault> make_protocol(
    const DeviceSpec& device, const LineFormat& line);

}  // namespace fieldcast
