// The message for a record that no outlet can send.
#pragma once

#include "tools/forward/batch/record.hpp"

namespace fieldcast::forward {

// The outlet reports kRefused for such a record.
void log_undecodable(const Record& record);

}  // namespace fieldcast::forward
