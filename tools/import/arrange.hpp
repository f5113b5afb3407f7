// Makes what the readers found fit for a configuration: one bus for each port, names and addresses
// that are unique and allowed, ports and protocols where a list says none. Pure.
#pragma once

#include "tools/import/importer.hpp"

namespace fieldcast::importing {

// Points that cannot be named alike are named apart; what was taken for granted becomes a note.
void arrange(Found& found, const ImportOptions& options);

// Nothing of the device moves: a refusal for each of its points, which are taken away. "its bus
// (telegraf.conf:12): REASON", with the place where the list says the bus, if it does.
void refuse_device(Device& device, std::string_view whose, const Origin& where,
                   const std::string& reason, std::vector<Refusal>& refusals);

}  // namespace fieldcast::importing
