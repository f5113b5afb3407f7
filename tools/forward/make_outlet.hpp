// Makes the outlet for the engine of the configuration.
#pragma once

#include <memory>

#include "tools/forward/outlet/outlet.hpp"
#include "tools/forward/settings/configuration.hpp"

namespace fieldcast::forward {

[[nodiscard]] std::unique_ptr<Outlet> make_outlet(const OutletSpec& spec, OutletContext context);

}  // namespace fieldcast::forward
