#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/bytes.hpp"
#include "core/base/json.hpp"
#include "core/protocol/protocol.hpp"
#include "tools/cli/doctor/findings.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

[[nodiscard]] std::vector<std::string> doctor_lines(const std::vector<Finding>& findings,
                                                    const Screen& screen);

// {"severity","check","where","what","remedy"}
[[nodiscard]] Json finding_json(const Finding& finding);

[[nodiscard]] std::size_t count_faults(std::span<const FrameField> fields);

// One line for each field: offset, bytes, indented name and value. Faults follow, marked with "!!".
[[nodiscard]] std::vector<std::string> inspect_lines(std::string_view protocol, ByteView frame,
                                                     std::span<const FrameField> fields,
                                                     const Screen& screen);

// {"protocol", "frame", "fields": [{"depth", "offset", "length", "name", "value", "fault"}],
// "faults": how many}
[[nodiscard]] Json inspect_json(std::string_view protocol, ByteView frame,
                                std::span<const FrameField> fields);

}  // namespace fieldcast::cli
