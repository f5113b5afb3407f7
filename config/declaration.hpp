// The text of a declared protocol to its model (core/protocol/declared/declaration.hpp).
// config/protocols/README.md teaches the format.
#pragma once

#include <string>

#include "config/fault_list.hpp"
#include "core/protocol/declared/declaration.hpp"

namespace fieldcast::config {

// Nothing when there was a fault; all of them are noted.
[[nodiscard]] declared::SharedDeclaration read_declaration(const Node& root,
                                                           const std::string& name,
                                                           FaultList& faults);

}  // namespace fieldcast::config
