// The section `commands`: which user of the centre may write which channels.
#pragma once

#include <optional>

#include "tools/forward/settings/outlet_sections.hpp"

namespace fieldcast::forward {

// Empty without the section. Only NATS carries commands.
[[nodiscard]] std::optional<CommandSpec> read_commands(config::MapReader& file,
                                                       const OutletSpec& outlet);
void document_commands(const AddKeys& add);

}  // namespace fieldcast::forward
