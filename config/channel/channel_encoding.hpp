// The key `exponent-from` of a channel: the register that holds the decimal exponent of its value.
#pragma once

#include <string>

#include "config/document/map_reader.hpp"
#include "core/codec/value_codec.hpp"
#include "core/model/channel_spec.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast::config {

inline constexpr std::string_view kExponentKey = "exponent-from";

// Reads spec.exponent_from and spec.encoding.exponent_distance. `value`: the channel's address;
// null after a fault: not checked. REQUIRES: the type of spec.encoding fits there.
void read_exponent(MapReader& map, const Protocol* protocol, const ParsedAddress* value,
                   ChannelSpec& spec);

// The key `not-available` of a channel: raw values that mean "no value".

// `typed`: the type is known; otherwise the values are not read.
void read_not_available(MapReader& map, bool typed, Encoding& encoding);

[[nodiscard]] std::string not_available_schema();

}  // namespace fieldcast::config
