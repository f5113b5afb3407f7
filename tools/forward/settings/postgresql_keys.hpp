// The section `postgresql`.
#pragma once

#include "tools/forward/settings/outlet_sections.hpp"

namespace fieldcast::forward {

[[nodiscard]] OutletSpec read_postgresql(config::MapReader& file, const config::Node& section,
                                         config::Library& library);
void document_postgresql(const AddKeys& add);

}  // namespace fieldcast::forward
