// The section `prometheus`.
#pragma once

#include "tools/forward/settings/outlet_sections.hpp"

namespace fieldcast::forward {

[[nodiscard]] OutletSpec read_prometheus(config::MapReader& file, const config::Node& section,
                                         config::Library& library);
void document_prometheus(const AddKeys& add);

}  // namespace fieldcast::forward
