#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace fieldcast::importing {

// "1.5", "1,5" (decimal comma), "1e-3", "-7", "0x1F". Empty if not finite.
[[nodiscard]] std::optional<double> number_from(std::string_view text);

// A whole number without sign: "100", "0x64", "64h", "100.0". Empty for other text.
[[nodiscard]] std::optional<std::uint64_t> whole_from(std::string_view text);

}  // namespace fieldcast::importing
