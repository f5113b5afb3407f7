// Parses the cells for type, length, word order and access of a register list. Pure.
#pragma once

#include <optional>
#include <string_view>

#include "tools/import/points/types.hpp"
#include "tools/import/text/text.hpp"

namespace fieldcast::importing {

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

// Contains no value if the cell is empty or a dash. Fails for other text.
[[nodiscard]] Result<std::optional<Length>> length_from(std::string_view cell);

struct ListType {
  std::optional<TypeName> type;  // empty: the cell has no type
  bool open = false;             // "INT", "signed", "BCD", "Float": the length determines the width
  unsigned bits = 0;             // "2 words", "32 bits": only a width; else 0
};

// Fails for unknown words.
[[nodiscard]] Result<ListType> list_type_from(std::string_view cell);

// Width of the name alone; 0: a text without a length, or a bit.
[[nodiscard]] unsigned bits_of(const TypeName& type);

// "INT" of 32 bits is int32, "BCD" of 32 bits is bcd32. Empty if there is no such type.
[[nodiscard]] std::optional<ValueType> as_wide(ValueType type, unsigned bits);

}  // namespace fieldcast::importing
