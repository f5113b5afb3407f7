#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fieldcast {

// The candidate for a "did you mean" hint: the one with the fewest single-character edits (insert,
// delete, replace, swap of neighbours; ignoring case). Empty if that exceeds a third of the word
// (at least one edit is allowed), or the word has more than 64 characters. Pure.
[[nodiscard]] std::string_view near_miss(std::string_view word,
                                         std::span<const std::string_view> candidates);
[[nodiscard]] std::string near_miss(std::string_view word,
                                    const std::vector<std::string>& candidates);

}  // namespace fieldcast
