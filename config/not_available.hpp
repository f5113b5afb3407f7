// The key `not-available` of a channel: raw values by which its device says that it has no value.
#pragma once

#include <string>

#include "config/map_reader.hpp"
#include "core/codec/value_codec.hpp"

namespace fieldcast::config {

// Reads the key into encoding.not_available. With `typed` the type of the encoding is known, and
// the values are checked against it; without it they stay unread.
void read_not_available(MapReader& map, bool typed, Encoding& encoding);

// In JSON Schema what the key accepts: one value, or a list of them.
[[nodiscard]] std::string not_available_schema();

}  // namespace fieldcast::config
