// The fields of the request and the response of one group of exchanges. Pure.
#pragma once

#include "tools/cli/inspect/learn/groups.hpp"
#include "tools/cli/inspect/learn/proposal.hpp"

namespace fieldcast::learn {

// `known`: length fields of other operations, for responses that all have one length.
[[nodiscard]] LearnedOperation fields_of(const Group& group, const Roles& roles,
                                         const std::vector<LengthField>& known);

}  // namespace fieldcast::learn
