// Parses a declared protocol; see config/protocols/README.md for the format.
#pragma once

#include <string>

#include "config/document/fault_list.hpp"
#include "core/protocol/declared/declaration.hpp"

namespace fieldcast::config {

// Null after a fault; adds all faults.
[[nodiscard]] declared::SharedDeclaration read_declaration(const Node& root,
                                                           const std::string& name,
                                                           FaultList& faults);

}  // namespace fieldcast::config
