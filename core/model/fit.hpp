// Checks whether an address supports a value type, for channels and for commands. Pure functions.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/codec/value_codec.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

struct FitFault {
  enum class About : std::uint8_t { kType, kPart };  // kPart: the bit or byte of an item
  About about = About::kType;
  std::string what;        // "type int32 has 32 bits, 'VW10' has 16"
  std::string allowed;     // "a type of 16 bits"
  std::string suggestion;  // a type or an address, or empty
};

// Empty if it fits. `at`: the address as written; Encoding::bit contains its bit, if any.
[[nodiscard]] std::optional<FitFault> check_fit(std::string_view at, const ParsedAddress& address,
                                                const Area& area, const Encoding& encoding);

[[nodiscard]] constexpr bool is_field(const ParsedAddress& address) {
  return address.value_bits != 0 || address.text_characters != 0;
}

// Bits of the number at the address: 16 at VW10 although an item of its area has 8.
[[nodiscard]] unsigned bits_of_value(const ParsedAddress& address, const Area& area);

// "byte: low, byte: high" or "byte: 0 to 3".
[[nodiscard]] std::string byte_names(unsigned item_bits);

// Empty if a byte of an item can be written alone; otherwise the reason with `at`. To write the
// whole item could undo a write of the device.
[[nodiscard]] std::optional<std::string> why_no_byte_write(std::string_view at, const Area& area);

// The encoding with the form that the address has: its bit, a number as text, a string with its
// lengths.
[[nodiscard]] Encoding with_form_of(const ParsedAddress& address, Encoding encoding);

// The type of a value from its address, for the configuration and for commands. Pure functions.

// The type fixed by the family: bool for a bit, float32 for `float32:12` in DTC, bcd16 for T5 in
// C-mode of Omron, string(8) for a declared text of eight characters. Empty if the type is not
// fixed.
[[nodiscard]] std::optional<Encoding> fixed_type(const ParsedAddress& address, const Area& area);

// The fixed type, or an unsigned number with the width of the notation (VD100: uint32) or of one
// item (holding:100: uint16). A declared number has its declared sign; a number as text is a
// float64, a hexadecimal one a uint64. Empty if no type has this width.
[[nodiscard]] std::optional<Encoding> implied_type(const ParsedAddress& address, const Area& area);

}  // namespace fieldcast
