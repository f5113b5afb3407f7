// "Did you mean": the known word nearest to a misspelt one. Pure.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace fieldcast::config {

// The candidate that a typing person most likely meant, or nothing ("") when none is near: another
// program's word for it, a near miss (core/base/near_miss.hpp), or the beginning of a candidate
// ("float" for "float32").
[[nodiscard]] std::string closest(std::string_view word,
                                  std::span<const std::string_view> candidates);

// A key of ours, and how it would be written where its value differs from what other programs
// write: "format: 8N1" for "stopbits".
struct MeantKey {
  std::string key;   // nothing: no key is near
  std::string text;  // for the suggestion
};
[[nodiscard]] MeantKey meant_key(std::string_view word, std::span<const std::string_view> keys);

// What other programs' word for a value of this key means here, or nothing: "read-write" for
// `access: rw`.
[[nodiscard]] std::string meant_value(std::string_view key, std::string_view written);

// "a, b, c"
[[nodiscard]] std::string joined(std::span<const std::string_view> words);

}  // namespace fieldcast::config
