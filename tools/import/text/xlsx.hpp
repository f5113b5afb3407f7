// Converts the first sheet of an .xlsx workbook to a text table. Pure. Limits: kMaxUnpacked bytes
// of each part, and those of table.hpp.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "tools/import/text/text.hpp"

namespace fieldcast::importing {

inline constexpr std::size_t kMaxUnpacked = 32u << 20;

[[nodiscard]] bool is_xlsx(std::string_view bytes);

// Cells are separated by tabs. The error describes the fault.
[[nodiscard]] tl::expected<Decoded, std::string> table_of_xlsx(std::string_view bytes);

}  // namespace fieldcast::importing
