// Hash of the configuration that all bridges of a standby group must share: buses, devices and
// channels, without the ports. Pure.
#pragma once

#include <string>

#include "core/model/spec.hpp"

namespace fieldcast {

[[nodiscard]] std::string common_configuration(const BridgeSpec& spec);

}  // namespace fieldcast
