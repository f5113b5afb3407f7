// What the request on the wire is for, in one line for people: for captures of the wire. Pure.
#pragma once

#include <string>

#include "core/bus/bus_parts.hpp"

namespace fieldcast {

// "press-1: read holding:100..109 (oil-temperature, running, +3)". Empty: nothing is on the wire.
[[nodiscard]] std::string flight_text(const BusParts& parts);

}  // namespace fieldcast
