#pragma once

#include <string>

#include "core/bus/bus_parts.hpp"

namespace fieldcast {

// "press-1: read holding:100..109 (oil-temperature, running, +3)"; empty without a request.
[[nodiscard]] std::string flight_text(const BusParts& parts);

}  // namespace fieldcast
