#pragma once

#include <memory>

#include "core/model/bus_spec.hpp"

namespace fieldcast {

// Creates the protocol of a device, built-in or declared. `line`: of the device's bus, for wire
// times. Fails if the protocol is unknown, or does not accept the address or an option; the loader
// has checked this. Pure; any thread.
[[nodiscard]] tl::expected<std::unique_ptr<Protocol>, OptionFault> make_protocol(
    const DeviceSpec& device, const LineFormat& line);

}  // namespace fieldcast
