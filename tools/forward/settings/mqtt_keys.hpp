// The sections `mqtt` and `sparkplug`.
#pragma once

#include "tools/forward/settings/outlet_sections.hpp"

namespace fieldcast::forward {

[[nodiscard]] OutletSpec read_mqtt(config::MapReader& file, const config::Node& section,
                                   config::Library& library);
void document_mqtt(const AddKeys& add);
[[nodiscard]] OutletSpec read_sparkplug(config::MapReader& file, const config::Node& section,
                                        config::Library& library);
void document_sparkplug(const AddKeys& add);

}  // namespace fieldcast::forward
