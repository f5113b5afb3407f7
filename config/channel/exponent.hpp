// The key `exponent-from` of a channel: the register that holds the decimal exponent of its value.
#pragma once

#include "config/document/map_reader.hpp"
#include "core/model/channel_spec.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast::config {

inline constexpr std::string_view kExponentKey = "exponent-from";

// Reads the key into spec.exponent_from and spec.encoding.exponent_distance. `value` is the address
// of the channel in `protocol`; null if the address or the type has a fault, then the key is not
// checked. REQUIRES: the type of spec.encoding fits there.
void read_exponent(MapReader& map, const Protocol* protocol, const ParsedAddress* value,
                   ChannelSpec& spec);

}  // namespace fieldcast::config
