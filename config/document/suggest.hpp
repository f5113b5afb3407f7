#pragma once

#include <span>
#include <string>
#include <string_view>

namespace fieldcast::config {

// The candidate for a "did you mean" hint: another program's word, a near miss, or one that begins
// with the word ("float" for "float32"). Empty if there is none. Pure.
[[nodiscard]] std::string closest(std::string_view word,
                                  std::span<const std::string_view> candidates);

// `text`: the entry to write, for example "format: 8N1" for "stopbits".
struct MeantKey {
  std::string key;   // empty if there is none
  std::string text;  // for the suggestion
};
[[nodiscard]] MeantKey meant_key(std::string_view word, std::span<const std::string_view> keys);

// Our value for another program's word, or empty: "read-write" for `access: rw`.
[[nodiscard]] std::string meant_value(std::string_view key, std::string_view written);

// "a, b, c".
[[nodiscard]] std::string joined(std::span<const std::string_view> words);

}  // namespace fieldcast::config
