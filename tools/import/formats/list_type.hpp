// The cells of a register list that say of which type and how wide a value is. Pure.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "tools/import/model.hpp"
#include "tools/import/types.hpp"

namespace fieldcast::importing {

enum class LengthUnit : std::uint8_t { kWords, kBytes, kBits };

struct Length {
  unsigned number = 0;
  std::optional<LengthUnit> unit;  // "32 bits", "2 words"; nothing: a number alone
  [[nodiscard]] unsigned bits(LengthUnit as) const;
};

// Nothing inside: the cell is empty, or a dash. The error says that it is no length.
[[nodiscard]] tl::expected<std::optional<Length>, std::string> length_from(std::string_view cell);

struct ListType {
  std::optional<TypeName> type;  // nothing: the cell names none
  bool open = false;             // "INT", "signed", "BCD", "Float": the length may say more
  unsigned bits = 0;             // "2 words", "32 bits": how wide it is, and no more; else 0
};

// The error: the words are not understood.
[[nodiscard]] tl::expected<ListType, std::string> list_type_from(std::string_view cell);

// How wide the name alone says it is; 0: a text without a length, or a bit.
[[nodiscard]] unsigned bits_of(const TypeName& type);

// "INT" of 32 bits is an int32, "BCD" of 32 bits a bcd32. Nothing: there is none as wide.
[[nodiscard]] std::optional<ValueType> as_wide(ValueType type, unsigned bits);

}  // namespace fieldcast::importing
