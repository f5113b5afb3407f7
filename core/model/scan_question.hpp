// Requests that change nothing in any device and show whether one responds. Pure.
#pragma once

#include <string>
#include <vector>

#include "core/protocol/declared/declaration.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

// Reads one item of an area.
struct ScanQuestion {
  std::string at;  // "holding:0"
  Range range;
};

// One or two requests of different areas, because a device may ignore areas that it does not have.
// A declared record is read completely. `declaration`: empty for a built-in protocol.
[[nodiscard]] std::vector<ScanQuestion> scan_questions(
    const Protocol& protocol, const declared::SharedDeclaration& declaration);

}  // namespace fieldcast
