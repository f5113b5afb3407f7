// The section `kafka`.
#pragma once

#include "tools/forward/settings/outlet_sections.hpp"

namespace fieldcast::forward {

[[nodiscard]] OutletSpec read_kafka(config::MapReader& file, const config::Node& section,
                                    config::Library& library);
void document_kafka(const AddKeys& add);

}  // namespace fieldcast::forward
