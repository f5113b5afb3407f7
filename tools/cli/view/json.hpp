// JSON lines: field names and values of the IDL. Pure functions.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "core/base/value.hpp"

namespace fieldcast::cli {

using Json = nlohmann::ordered_json;  // fields stay in the order in which they were written

// A plain JSON value: integers exact to 64 bits, doubles that round-trip, null for NaN and
// infinities, bytes of a text that are no UTF-8 as \xE4.
[[nodiscard]] Json to_json(const Value& value);

// One line without its end; bytes that are no UTF-8 become U+FFFD, and a character that is not
// is_printable() (core/base/printable.hpp) is written as \u202e.
[[nodiscard]] std::string to_line(const Json& json);

}  // namespace fieldcast::cli
