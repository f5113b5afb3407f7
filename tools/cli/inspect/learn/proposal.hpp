// Proposes the fields of an unknown protocol from its exchanges. Pure values and functions.
//
//   exchanges -> groups (one for each operation) -> roles of columns -> fields of each frame
#pragma once

#include <algorithm>

#include "tools/cli/inspect/learn/operation_fields.hpp"

namespace fieldcast::learn {

struct Proposal {
  bool text = false;
  std::vector<LearnedOperation> operations;
  std::uint64_t lowest_address = 1, highest_address = 1;  // 1 to 1: frames have no address
  std::vector<std::string> notes;
  [[nodiscard]] bool is_declarable() const {
    return std::ranges::any_of(operations, [](const auto& each) { return each.refusal.empty(); });
  }
};

[[nodiscard]] Proposal learn(const std::vector<Exchange>& exchanges);

// Frames in which the declaration finds no fault.
[[nodiscard]] Evidence explained_by(const declared::Declaration& declaration,
                                    const std::vector<Exchange>& exchanges);

}  // namespace fieldcast::learn
