// The section `influxdb`.
#pragma once

#include "tools/forward/settings/outlet_sections.hpp"

namespace fieldcast::forward {

[[nodiscard]] OutletSpec read_influxdb(config::MapReader& file, const config::Node& section,
                                       config::Library& library);
void document_influxdb(const AddKeys& add);

}  // namespace fieldcast::forward
