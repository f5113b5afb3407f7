// The key `not-available` of a channel: raw values that mean "no value".
#pragma once

#include <string>

#include "config/document/map_reader.hpp"
#include "core/codec/value_codec.hpp"

namespace fieldcast::config {

// `typed`: the type is known; otherwise the values are not read.
void read_not_available(MapReader& map, bool typed, Encoding& encoding);

[[nodiscard]] std::string not_available_schema();

}  // namespace fieldcast::config
