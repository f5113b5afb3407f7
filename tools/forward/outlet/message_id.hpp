// The id by which engines and consumers recognise a repeated message. Pure.
#pragma once

#include <string>
#include <string_view>

#include "tools/forward/batch/record.hpp"

namespace fieldcast::forward {

// "SITE/BUS/EPOCH/IDENTITY": equal for each repetition of the record, on any machine.
[[nodiscard]] std::string message_id_of(std::string_view site, const Record& record);

}  // namespace fieldcast::forward
