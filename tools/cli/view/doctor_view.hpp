#pragma once

#include <string>
#include <vector>

#include "core/base/json.hpp"
#include "tools/cli/doctor/findings.hpp"
#include "tools/cli/text/text_table.hpp"

namespace fieldcast::cli {

[[nodiscard]] std::vector<std::string> doctor_lines(const std::vector<Finding>& findings,
                                                    const Screen& screen);

// {"severity","check","where","what","remedy"}
[[nodiscard]] Json finding_json(const Finding& finding);

}  // namespace fieldcast::cli
