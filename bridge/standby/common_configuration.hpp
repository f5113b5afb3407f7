// What the bridges of a standby group must have in common: buses, devices and channels, but not the
// ports by which they are reached. A short text that is the same where those are. Pure.
#pragma once

#include <string>

#include "core/model/spec.hpp"

namespace fieldcast {

[[nodiscard]] std::string common_configuration(const BridgeSpec& spec);

}  // namespace fieldcast
