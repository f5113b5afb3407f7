// Prepares imported data for a configuration, and validates it with the bridge's loader. Pure.
#pragma once

#include "config/document/fault.hpp"
#include "tools/import/importer.hpp"

namespace fieldcast::importing {

// One bus for each port, unique valid names and addresses, default ports and protocols. Assumptions
// become notes.
void arrange(Found& found, const ImportOptions& options);

// Moves each rejected point from `found.buses` to `found.refusals`, with the loader's message,
// until the rest is valid. Fails if the user must fix an option. REQUIRES: arrange() was called.
[[nodiscard]] Result<std::vector<WrittenFile>> write_accepted(Found& found,
                                                              const ImportOptions& options,
                                                              const std::string& head,
                                                              const Progress& progress = {});

[[nodiscard]] std::string reason_of(const config::Fault& fault);

void drop_empty(Found& found);

// Refuses all points of the device: "its bus (telegraf.conf:12): REASON".
void refuse_device(Device& device, std::string_view whose, const Origin& where,
                   const std::string& reason, std::vector<Refusal>& refusals);

}  // namespace fieldcast::importing
