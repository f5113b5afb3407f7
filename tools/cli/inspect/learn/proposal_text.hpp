// A proposal as a table and as the text of a declaration (config/protocols/README.md). Pure.
#pragma once

#include <string>
#include <vector>

#include "tools/cli/inspect/learn/proposal.hpp"

namespace fieldcast::learn {

struct FieldRow {
  std::string frame;      // "request" or "response"
  std::ptrdiff_t at = 0;  // below 0: from the end
  std::size_t width = 0;  // characters; 0: not always the same
  std::string content;    // as in the declaration
  std::size_t frames = 0, of = 0;
  std::string note;  // why it is unsure
};
[[nodiscard]] std::vector<FieldRow> rows_of(const LearnedOperation& operation, bool text);

// Operations that cannot be declared are comments; only comments if none can.
[[nodiscard]] std::string declaration_text(const Proposal& proposal);

}  // namespace fieldcast::learn
