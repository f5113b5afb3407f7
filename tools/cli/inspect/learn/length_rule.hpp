// Finds which field decides the length of a frame. Pure.
#pragma once

#include <functional>

#include "tools/cli/inspect/learn/frames.hpp"

namespace fieldcast::learn {

// The length of a response: items of so many characters, and `base` others.
struct LengthRule {
  std::ptrdiff_t at = -1;  // of the count in the request; -1: the length is constant
  declared::Word word;
  bool is_last = false;  // `at` is the first item, and the last one follows it
  unsigned times = 0;    // characters of `shared` items
  unsigned shared = 1;   // 8 for bits
  std::size_t base = 0;  // other characters of the response
  Evidence evidence;
  std::uint64_t lowest = 0, highest = 0;  // items
  [[nodiscard]] std::optional<std::uint64_t> items_in(ByteView request) const;
  [[nodiscard]] bool fits(ByteView request, ByteView response) const;
};
// `may_use(at, characters)`: the columns of the request that can be a count.
using MayUse = std::function<bool(std::size_t at, std::size_t characters)>;
// `like`: of several rules that fit equally, the one with the count of this rule.
[[nodiscard]] std::optional<LengthRule> find_length_rule(const Frames& requests,
                                                         const Frames& responses, bool text,
                                                         const MayUse& may_use,
                                                         const LengthRule* like = nullptr);

// A field with the length of its own frame: `without` characters do not count.
struct LengthField {
  std::ptrdiff_t at = 0;
  declared::Word word;
  unsigned unit = 1;  // characters that it counts as one: 2 for bytes in hexadecimal digits
  std::size_t without = 0;
  Evidence evidence;
  std::string note;
  [[nodiscard]] bool fits(ByteView frame) const;
};
// All that fit frames of different lengths, from the start of the frame on.
[[nodiscard]] std::vector<LengthField> find_length_fields(const Frames& frames, bool text);

}  // namespace fieldcast::learn
