// Numbers as lists write them. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace fieldcast::importing {

// "1.5", "1,5" (of a spreadsheet with decimal commas), "1e-3", "-7", "0x1F"; blanks around are
// fine. Nothing for anything else, and for what is not finite.
[[nodiscard]] std::optional<double> number_from(std::string_view text);

// A whole number without sign: "100", "0x64", "64h", "100.0". Nothing for anything else.
[[nodiscard]] std::optional<std::uint64_t> whole_from(std::string_view text);

}  // namespace fieldcast::importing
