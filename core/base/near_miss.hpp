// "Did you mean": the candidate that a misspelt word was probably meant to be. Pure.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fieldcast {

// The candidate with the fewest single-character edits (insert, delete, replace, swap of
// neighbours; case does not count), if that is at most a third of the word, and at least one edit
// is allowed; else empty. Words past 64 characters have no near miss.
[[nodiscard]] std::string_view near_miss(std::string_view word,
                                         std::span<const std::string_view> candidates);
[[nodiscard]] std::string near_miss(std::string_view word,
                                    const std::vector<std::string>& candidates);

}  // namespace fieldcast
