// The section `jetstream`.
#pragma once

#include "tools/forward/settings/outlet_sections.hpp"

namespace fieldcast::forward {

[[nodiscard]] OutletSpec read_jetstream(config::MapReader& file, const config::Node& section,
                                        config::Library& library);
void document_jetstream(const AddKeys& add);

}  // namespace fieldcast::forward
