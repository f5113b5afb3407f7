#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/base/json.hpp"
#include "core/model/status.hpp"
#include "tools/cli/text/text_table.hpp"

namespace fieldcast::cli {

// By bus and device.
using SessionsModel = std::map<std::pair<std::string, std::string>, ProgramSessionReport>;

[[nodiscard]] std::vector<std::string> sessions_lines(const SessionsModel& model, UtcTime now,
                                                      const Screen& screen);

// The fields of ProgramSession by their IDL names. Times in nanoseconds.
[[nodiscard]] Json session_json(const ProgramSessionReport& session);

}  // namespace fieldcast::cli
