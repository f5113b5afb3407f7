// Parses the cells for word order and access of a register list. Pure.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "tools/import/points/model.hpp"

namespace fieldcast::importing {

struct ListOrder {
  std::optional<WordOrder> words;
  std::optional<ByteOrder> bytes;
  bool little_alone = false;  // "little endian": certain for words, possible for bytes
};

// "CDAB", "3412", "LSW first", "low/high", "swapped", "Little-Endian", "big-endian byte swap".
// Empty for an empty cell. `of_bytes`: the title is about bytes, so "swapped" is ambiguous. Fails
// for other text.
[[nodiscard]] tl::expected<ListOrder, std::string> list_order_from(std::string_view cell,
                                                                   bool of_bytes);

// "RO", "R/W", "R(W)", "lesen/schreiben", "W"; empty for other text.
[[nodiscard]] std::optional<Access> access_from(std::string_view cell);

}  // namespace fieldcast::importing
