// The fields of one frame while they are found: no two of them share a column. Pure.
#pragma once

#include <set>
#include <vector>

#include "tools/cli/inspect/learn/proposal.hpp"

namespace fieldcast::learn {

class FieldLayout {
 public:
  // `end`: columns from the start of the frame that may be used.
  FieldLayout(const Frames& frames, std::ptrdiff_t end, bool text)
      : frames_(frames), end_(end), text_(text) {}

  // False if a column has a field already, or is beyond the end.
  bool add(LearnedField field);
  [[nodiscard]] bool is_free(std::ptrdiff_t at, std::size_t width) const;
  // A field begins here, at the latest.
  void cut(std::ptrdiff_t at) { cuts_.insert(at); }
  // Uses fewer columns. REQUIRES: no field is behind them.
  void shorten(std::ptrdiff_t end) { end_ = end; }
  // The first column behind all fields.
  [[nodiscard]] std::ptrdiff_t used() const;
  // Fields for the columns that have none: constants, or `others`.
  void fill(declared::FieldKind others, const std::string& note);
  [[nodiscard]] std::vector<LearnedField> take();

 private:
  [[nodiscard]] bool is_varying(std::ptrdiff_t column) const;
  [[nodiscard]] bool is_hex(std::ptrdiff_t at, std::ptrdiff_t end) const;

  const Frames& frames_;
  std::ptrdiff_t end_;
  const bool text_;
  std::set<std::ptrdiff_t> cuts_;
  std::vector<LearnedField> fields_;
};

[[nodiscard]] LearnedField constant_field(const Frames& frames, std::ptrdiff_t at,
                                          std::size_t width);
// As a declaration names it: "address".
[[nodiscard]] std::string word_of(declared::FieldKind kind);
// Makes the names of a frame unique.
void name_fields(std::vector<LearnedField>& fields);

// The values of a record, in the columns from `at` on and before the last `end_size` ones. Empty if
// the responses have no common form.
[[nodiscard]] std::vector<LearnedField> text_values(const Frames& frames, std::size_t at,
                                                    std::size_t end_size);

}  // namespace fieldcast::learn
