// A proposal as the text of a declaration (config/protocols/README.md). Pure.
#pragma once

#include "tools/cli/inspect/learn/proposal.hpp"

namespace fieldcast::learn {

// "is: count, bytes: 2": the field, without its name.
[[nodiscard]] std::string content_of(const LearnedField& field, bool text);

// Each field has its position, its frames and its note in a comment. Operations that cannot be
// declared are comments; only comments if none can.
[[nodiscard]] std::string declaration_text(const Proposal& proposal);

}  // namespace fieldcast::learn
