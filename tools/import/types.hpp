// Data types by the many names that lists have for them, and orders of bytes. Pure.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "tools/import/model.hpp"

namespace fieldcast::importing {

struct TypeName {
  ValueType type = ValueType::kUint16;
  std::uint16_t string_bytes = 0;       // of a text; 0: the name does not say
  std::optional<std::uint8_t> byte;     // "INT8L", "INT8H"
  std::optional<WordOrder> word_order;  // "FLOAT32_LE", "long inverse"
  std::optional<ByteOrder> byte_order;  // "FLOAT32_BE_BS"
};

// "Float", "REAL", "32-bit float", "UINT32 (little endian)", "S16", "String[20]". Nothing if the
// words are unknown.
[[nodiscard]] std::optional<TypeName> type_by_name(std::string_view name);

struct Orders {
  WordOrder words = WordOrder::kBigEndian;
  ByteOrder bytes = ByteOrder::kBigEndian;
};
// "ABCD", "CDAB", "BADC", "DCBA", "AB", "BA", and those of eight letters; as lists name them.
[[nodiscard]] std::optional<Orders> orders_by_letters(std::string_view letters);

// Registers of 16 bits that a value takes.
[[nodiscard]] unsigned registers_of(ValueType type, std::uint16_t string_bytes);

[[nodiscard]] inline bool is_number(ValueType type) {
  return type != ValueType::kBool && type != ValueType::kString;
}
// The type of as many bits with or without a sign, of int8 to uint64.
[[nodiscard]] std::optional<ValueType> integer_of(unsigned bits, bool with_sign);

}  // namespace fieldcast::importing
