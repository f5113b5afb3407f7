// The fields of the request and the response of one group of exchanges. Pure.
#pragma once

#include "tools/cli/inspect/learn/groups.hpp"
#include "tools/cli/inspect/learn/length_rule.hpp"

namespace fieldcast::learn {

struct LearnedOperation {
  std::string name;
  std::vector<LearnedField> request, response;  // no request: the device sends by itself
  std::optional<std::uint64_t> command;
  unsigned item_bits = 0;  // 0: a record
  std::uint64_t lowest_count = 1, highest_count = 1;
  std::uint64_t origin = 0, items = 0;  // of the area
  std::size_t exchanges = 0;
  std::optional<LengthRule> rule;  // of the length of its responses
  std::string refusal;             // why it is not in the declaration; empty if it is
};

// What other operations of the protocol show, where the frames of one are too few.
struct Known {
  std::vector<LengthRule> lengths;  // of responses
  std::optional<LengthRule> rule;   // of the most exchanges
};
// `values`: how many values have a name.
[[nodiscard]] LearnedOperation fields_of(const Group& group, const Roles& roles, const Known& known,
                                         unsigned& values);

}  // namespace fieldcast::learn
