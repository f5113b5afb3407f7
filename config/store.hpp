// The `store` section: where samples, users and the audit are kept, and for how long.
#pragma once

#include <optional>

#include "config/map_reader.hpp"
#include "core/model/spec.hpp"

namespace fieldcast::config {

void read_store(MapReader& bridge, std::optional<StoreSpec>& spec);

}  // namespace fieldcast::config
