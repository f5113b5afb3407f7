// Divides texts into numbers, other values and constants. Pure.
#pragma once

#include "tools/cli/inspect/learn/learned_field.hpp"

namespace fieldcast::learn {

// The fields in the columns from `at` on and before the last `end_size` ones; their positions are
// those of the first frame. Empty if the frames have no common form.
[[nodiscard]] std::vector<LearnedField> text_values(const Frames& frames, std::size_t at,
                                                    std::size_t end_size);

}  // namespace fieldcast::learn
