// Makes what the readers found fit for a configuration: one bus for each port, names and addresses
// that are unique and allowed, ports and protocols where a list says none. Pure.
#pragma once

#include "tools/import/importer.hpp"

namespace fieldcast::importing {

// Points that cannot be named alike are named apart; what was taken for granted becomes a note.
void arrange(Found& found, const ImportOptions& options);

}  // namespace fieldcast::importing
