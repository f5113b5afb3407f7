// Prepares imported data for a configuration: one bus for each port, unique valid names and
// addresses, default ports and protocols. Pure.
#pragma once

#include "tools/import/importer.hpp"

namespace fieldcast::importing {

// Duplicate names become unique; assumptions become notes.
void arrange(Found& found, const ImportOptions& options);

// Refuses all points of the device: "its bus (telegraf.conf:12): REASON".
void refuse_device(Device& device, std::string_view whose, const Origin& where,
                   const std::string& reason, std::vector<Refusal>& refusals);

}  // namespace fieldcast::importing
