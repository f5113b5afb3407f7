// The cells of a register list that say the order of words, and who may write. Pure.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "tools/import/model.hpp"

namespace fieldcast::importing {

struct ListOrder {
  std::optional<WordOrder> words;
  std::optional<ByteOrder> bytes;
  bool little_alone = false;  // "little endian": of words for sure, of bytes perhaps
};

// "CDAB", "3412", "LSW first", "low/high", "swapped", "Little-Endian", "big-endian byte swap".
// Empty where the cell is. `of_bytes`: the title speaks of bytes, where "swapped" may mean either.
// The error: it is not understood.
[[nodiscard]] tl::expected<ListOrder, std::string> list_order_from(std::string_view cell,
                                                                   bool of_bytes);

// "RO", "R/W", "R(W)", "lesen/schreiben", "W"; nothing: it is not understood.
[[nodiscard]] std::optional<Access> access_from(std::string_view cell);

}  // namespace fieldcast::importing
