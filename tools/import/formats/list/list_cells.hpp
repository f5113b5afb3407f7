// Parses the cells of a register list: address, factor, type, length, word order and access. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "tools/import/points/address.hpp"
#include "tools/import/points/types.hpp"
#include "tools/import/text/text.hpp"

namespace fieldcast::importing {

[[nodiscard]] inline bool is_empty_cell(std::string_view cell) {
  return cell.empty() || cell == "-";
}

// Possible meanings of a cell. "40001" may be a reference (holding register 0) or a plain number;
// the other rows decide. "4x0001" is only a reference, "100" only a number.
struct ListAddress {
  std::optional<Reference> reference;  // its area is known
  std::optional<std::uint32_t> plain;  // 0 to 65535
  std::optional<std::uint8_t> bit;
  unsigned registers = 0;   // "100-101" has 2; 0: a single number
  bool marked_hex = false;  // "0x10", "10h", "$10"

  [[nodiscard]] bool is_open() const { return reference && plain; }
};

struct AddressNotation {
  bool hex = false;   // unmarked digits are hexadecimal
  unsigned base = 1;  // first number after the area digit
};

// "40101", "4x0101", "%MW100", "0x64", "100 (0x64)", "100-101", "100..103", "100 to 101", "100,
// 101", "30001/2", "40007 bit 3", "40007.3". The error is the reason.
[[nodiscard]] Result<ListAddress> list_address_from(std::string_view cell,
                                                    AddressNotation notation);

struct Factor {
  double value = 1;
  std::string unit;  // from the same cell: "0.1 kWh"
};

// Meaning of commas and dots in a column of numbers, learned from all cells.
struct NumberStyle {
  bool decimal_comma = false;  // "0,1" or "2,75" was found
  bool decimal_point = false;
  void learn(std::string_view cell);
};

// "0.1", "x0.1", "1/10", "/10", "÷10", "*0,01", "10^-1", "10**-2", "10⁻³", "2^-7", "1 × 10^-2", "1
// = 0.1", "0.1 V", "1:100". Contains no value for "-" or "none". The error is the reason.
[[nodiscard]] Result<std::optional<Factor>> factor_from(std::string_view cell, NumberStyle style);

// Returns the scale in the unit's cell, for example of "0.1 kW"; empty if there is none or it is
// not a power of ten.
[[nodiscard]] std::optional<Factor> factor_of_unit(std::string_view unit, NumberStyle style);

// "Value weight: Volt*10" in a remark: the device has multiplied by it. Empty if there is none.
[[nodiscard]] std::optional<double> weight_from(std::string_view remark);

struct ListOrder {
  std::optional<WordOrder> words;
  std::optional<ByteOrder> bytes;
  bool little_alone = false;  // "little endian": certain for words, possible for bytes
};

// "CDAB", "3412", "LSW first", "low/high", "swapped", "Little-Endian", "big-endian byte swap".
// Empty for an empty cell. `of_bytes`: the title is about bytes, so "swapped" is ambiguous. Fails
// for other text.
[[nodiscard]] Result<ListOrder> list_order_from(std::string_view cell, bool of_bytes);

// "RO", "R/W", "R(W)", "lesen/schreiben", "W"; empty for other text.
[[nodiscard]] std::optional<Access> access_from(std::string_view cell);

enum class LengthUnit : std::uint8_t { kWords, kBytes, kBits };

struct Length {
  unsigned number = 0;
  std::optional<LengthUnit> unit;  // "32 bits", "2 words"; empty: a number only
  [[nodiscard]] unsigned bits(LengthUnit as) const;
};

[[nodiscard]] Result<std::optional<Length>> length_from(std::string_view cell);

struct ListType {
  std::optional<TypeName> type;  // empty: the cell has no type
  bool open = false;             // "INT", "signed", "BCD", "Float": the length determines the width
  unsigned bits = 0;             // "2 words", "32 bits": only a width; else 0
};

[[nodiscard]] Result<ListType> list_type_from(std::string_view cell);

// Width of the name alone; 0: a text without a length, or a bit.
[[nodiscard]] unsigned bits_of(const TypeName& type);

// "INT" of 32 bits is int32, "BCD" of 32 bits is bcd32. Empty if there is no such type.
[[nodiscard]] std::optional<ValueType> as_wide(ValueType type, unsigned bits);

}  // namespace fieldcast::importing
