// The fields of the request and the response of one group of exchanges. Pure.
#pragma once

#include "tools/cli/inspect/learn/groups.hpp"

namespace fieldcast::learn {

// What other operations of the protocol show, where the frames of one are too few.
struct Known {
  std::vector<LengthRule> lengths;  // of responses
  std::optional<LengthRule> rule;   // of the most exchanges
};
// `values`: how many values have a name.
[[nodiscard]] LearnedOperation fields_of(const Group& group, const Roles& roles, const Known& known,
                                         unsigned& values);

}  // namespace fieldcast::learn
