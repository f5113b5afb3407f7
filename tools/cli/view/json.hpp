// JSON lines with field names and values of the IDL. Pure functions.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "core/base/value.hpp"

namespace fieldcast::cli {

using Json = nlohmann::ordered_json;  // keeps the order of fields

// Exact 64-bit integers, doubles that round-trip, null for NaN and infinities, invalid UTF-8 as
// \xE4.
[[nodiscard]] Json to_json(const Value& value);

// One line without line end. Invalid UTF-8 becomes U+FFFD; characters that are not is_printable()
// are escaped, for example \u202e.
[[nodiscard]] std::string to_line(const Json& json);

}  // namespace fieldcast::cli
