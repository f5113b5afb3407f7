#pragma once

#include "config/document/document.hpp"
#include "config/document/fault_list.hpp"

namespace fieldcast::config {

// Estimates the memory that the parser would need for a YAML text. Returns false with a fault where
// the text exceeds a limit (limits.hpp). Approximate: a bracket or quote within a plain text counts
// as one.
[[nodiscard]] bool check_tokens(const Source& source, FaultList& faults);

}  // namespace fieldcast::config
