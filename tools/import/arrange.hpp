// Prepares the imported data for a configuration: one bus for each port, unique valid names and
// addresses, and default ports and protocols. Pure.
#pragma once

#include "tools/import/importer.hpp"

namespace fieldcast::importing {

// Duplicate names become unique; assumptions become notes.
void arrange(Found& found, const ImportOptions& options);

// Removes all points of the device and refuses each with the reason: "its bus (telegraf.conf:12):
// REASON". The place is omitted if unknown.
void refuse_device(Device& device, std::string_view whose, const Origin& where,
                   const std::string& reason, std::vector<Refusal>& refusals);

}  // namespace fieldcast::importing
