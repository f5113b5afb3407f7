// The type of a value of which only the address is known: one rule for the configuration and for
// commands to addresses. Pure functions.
#pragma once

#include <optional>

#include "core/codec/value_codec.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

// The type that the family gives to what stands at the address: bool of a bit, float32 of
// `float32:12` in DTC, bcd16 of T5 in C-mode of Omron, string(8) of a declared text of eight
// characters. Nothing where it leaves the type open.
[[nodiscard]] std::optional<Encoding> fixed_type(const ParsedAddress& address, const Area& area);

// That type, or else an unsigned number of the width that the notation names (VD100: uint32) or
// that one item has (holding:100: uint16). A declared number has the sign that is declared, one
// that is spelt as text is a float64, in hexadecimal a uint64. Nothing where no type has this
// width.
[[nodiscard]] std::optional<Encoding> implied_type(const ParsedAddress& address, const Area& area);

}  // namespace fieldcast
