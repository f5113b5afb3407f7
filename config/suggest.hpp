// "Did you mean": the known word nearest to a misspelt one. Pure.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace fieldcast::config {

// The candidate that a typing person most likely meant, or nothing ("") when none is near: another
// program's word for it, a near miss (core/base/near_miss.hpp), or the beginning of a candidate ("float" for "float32").
[[nodiscard]] std::string closest(std::string_view word, std::span<const std::string_view> candidates);

// "a, b, c"
[[nodiscard]] std::string joined(std::span<const std::string_view> words);

}  // namespace fieldcast::config
