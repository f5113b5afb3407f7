// What a YAML text would make the parser hold at once, counted before the parser sees the text.
#pragma once

#include "config/document.hpp"
#include "config/fault_list.hpp"

namespace fieldcast::config {

// False and a fault at the position where the text goes above a limit (limits.hpp). The text is
// read roughly: what looks like a bracket or a quote inside a plain text counts as one.
[[nodiscard]] bool check_tokens(const Source& source, FaultList& faults);

}  // namespace fieldcast::config
