// Data types and byte orders by their names in lists. Pure.
#pragma once

#include <optional>
#include <string_view>

#include "tools/import/points/model.hpp"

namespace fieldcast::importing {

struct TypeName {
  ValueType type = ValueType::kUint16;
  std::uint16_t string_bytes = 0;       // of a text; 0: unknown
  std::optional<std::uint8_t> byte;     // "INT8L", "INT8H"
  std::optional<WordOrder> word_order;  // "FLOAT32_LE", "long inverse"
  std::optional<ByteOrder> byte_order;  // "FLOAT32_BE_BS"
};

// "Float", "REAL", "32-bit float", "UINT32 (little endian)", "S16", "String[20]". Empty if unknown.
[[nodiscard]] std::optional<TypeName> type_by_name(std::string_view name);

struct Orders {
  WordOrder words = WordOrder::kBigEndian;
  ByteOrder bytes = ByteOrder::kBigEndian;
};
// "ABCD", "CDAB", "BADC", "DCBA", "AB", "BA", and orders of eight letters.
[[nodiscard]] std::optional<Orders> orders_by_letters(std::string_view letters);

[[nodiscard]] unsigned registers_of(ValueType type, std::uint16_t string_bytes);

[[nodiscard]] inline bool is_number(ValueType type) {
  return type != ValueType::kBool && type != ValueType::kString;
}
[[nodiscard]] inline bool is_byte(ValueType type) {
  return type == ValueType::kInt8 || type == ValueType::kUint8;
}
[[nodiscard]] std::optional<ValueType> integer_of(unsigned bits, bool with_sign);

}  // namespace fieldcast::importing
