// "Did you mean": the nearest of the names that exist.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace fieldcast::cli {

// Letters to change, add, drop or swap with their neighbour. Ignores case.
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

// The name nearest to `wrong`, or empty when none is near enough to be a slip of the hand (a third of its letters).
[[nodiscard]] std::string nearest(std::string_view wrong, const std::vector<std::string>& names);

}  // namespace fieldcast::cli
