// Finds the number that decides the length of a frame. Pure.
#pragma once

#include <functional>
#include <string>

#include "tools/cli/inspect/learn/frames.hpp"

namespace fieldcast::learn {

// A frame has items of so many characters, and `base` others. Their number is in the request, or in
// a length field of the frame itself.
struct LengthRule {
  std::ptrdiff_t at = -1;  // of the number; -1: the length is constant
  declared::Word word;
  bool is_last = false;  // `at` is the first item, and the last one follows it
  unsigned times = 0;    // characters of `shared` items
  unsigned shared = 1;   // 8 for bits
  std::size_t base = 0;
  Evidence evidence;
  std::uint64_t lowest = 0, highest = 0;  // items
  std::string note;
  [[nodiscard]] bool fits(ByteView with_number, ByteView frame) const;
  // Sets the most frequent base, its evidence, and the fewest and most items.
  void measure(const Frames& with_number, const Frames& frames);
};

// `may_use(at, characters)`: the columns of the request that can be a count.
using MayUse = std::function<bool(std::size_t at, std::size_t characters)>;
// `like`: of several rules that fit equally, the one with the count of this rule.
[[nodiscard]] std::optional<LengthRule> find_length_rule(const Frames& requests,
                                                         const Frames& responses, bool text,
                                                         const MayUse& may_use,
                                                         const LengthRule* like = nullptr);

// Fields with the length of their own frame, if frames have different lengths; from the start of
// the frame on.
[[nodiscard]] std::vector<LengthRule> find_length_fields(const Frames& frames, bool text);

}  // namespace fieldcast::learn
