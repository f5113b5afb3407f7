// The fields of the frames of one direction while they are found: no two of them share a column.
// Pure; owned by the builder of an operation.
#pragma once

#include "tools/cli/inspect/learn/checksum_search.hpp"
#include "tools/cli/inspect/learn/proposal.hpp"

namespace fieldcast::learn {

class FrameFields {
 public:
  // `common`: the checksum of all frames of this direction, if they have one.
  FrameFields(const Frames& frames, const std::optional<FoundChecksum>& common, bool text);

  // A checksum, constants, or both: behind all fields.
  [[nodiscard]] std::size_t end_size() const { return end_size_; }
  [[nodiscard]] const std::optional<FoundChecksum>& check() const { return check_; }
  // The end of a variable text before it is known.
  [[nodiscard]] bool ends_with_constant() const {
    return end_size_ > 0 && (!check_ || check_->gap + marks_ > 0);
  }
  // Columns that may be used; REQUIRES: no field is behind them.
  [[nodiscard]] std::ptrdiff_t limit() const { return limit_; }
  void set_limit(std::ptrdiff_t limit) { limit_ = limit; }

  // False if a column has a field already, is beyond the limit, or begins what a field covers.
  bool add(LearnedField field);
  [[nodiscard]] bool is_free(std::ptrdiff_t at, std::size_t width) const;
  // The first column behind all fields, and where the first covered one begins at the latest.
  [[nodiscard]] std::ptrdiff_t used() const;
  // Fields for the columns that have none: constants, or `others`.
  void fill(declared::FieldKind others, const std::string& note);
  // A field behind the limit.
  void append(const LearnedField& field) { fields_.push_back(field); }
  // In their order, with the end and unique names. `values`: how many values have a name.
  [[nodiscard]] std::vector<LearnedField> finish(unsigned& values);

 private:
  void set_end(const std::optional<FoundChecksum>& common);
  void add_constant(std::size_t from_end, std::size_t width);
  void add_end();

  const Frames& frames_;
  const bool text_;
  std::optional<FoundChecksum> check_;
  std::size_t marks_ = 0;  // constants before the checksum, which covers them
  std::size_t end_size_ = 0;
  std::ptrdiff_t limit_ = 0;
  std::set<std::ptrdiff_t> covered_;  // the first columns of what lengths and the checksum cover
  std::vector<LearnedField> fields_;
};

// Divides texts into numbers, other values and constants: the fields in the columns from `at` on
// and before the last `end_size` ones; their positions are those of the first frame. Empty if the
// frames have no common form.
[[nodiscard]] std::vector<LearnedField> text_values(const Frames& frames, std::size_t at,
                                                    std::size_t end_size);

[[nodiscard]] LearnedField constant_field(ByteView bytes, std::ptrdiff_t at);

}  // namespace fieldcast::learn
