// The type of a value from its address, for the configuration and for commands. Pure functions.
#pragma once

#include <optional>

#include "core/codec/value_codec.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

// The type fixed by the family: bool for a bit, float32 for `float32:12` in DTC, bcd16 for T5 in
// C-mode of Omron, string(8) for a declared text of eight characters. Empty if the type is not
// fixed.
[[nodiscard]] std::optional<Encoding> fixed_type(const ParsedAddress& address, const Area& area);

// The fixed type, or an unsigned number with the width of the notation (VD100: uint32) or of one
// item (holding:100: uint16). A declared number has its declared sign; a number as text is a
// float64, a hexadecimal one a uint64. Empty if no type has this width.
[[nodiscard]] std::optional<Encoding> implied_type(const ParsedAddress& address, const Area& area);

}  // namespace fieldcast
