// Whether the numbers in a column of lengths are words, bytes or bits: what agrees with the types
// that say their width, or else with the addresses, which lie one behind the other. Pure.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "tools/import/formats/list_type.hpp"

namespace fieldcast::importing {

// "Size (bytes)", "Number of registers", "Words", "Bits"; nothing: the title does not say.
[[nodiscard]] std::optional<LengthUnit> length_unit_of_title(std::string_view title);

class LengthVote {
 public:
  // A value whose type says how wide it is.
  void add_type(const Length& length, unsigned bits);
  // A value behind which the next one lies `step` registers further.
  void add_step(const Length& length, std::uint32_t step);
  // What most say; nothing: nobody does, or they disagree.
  [[nodiscard]] std::optional<LengthUnit> unit() const;

 private:
  using Votes = std::array<std::size_t, 3>;  // by LengthUnit
  static void add(Votes& votes, const Length& length, unsigned bits);
  static std::optional<LengthUnit> most(const Votes& votes);

  Votes by_type_{}, by_step_{};
};

}  // namespace fieldcast::importing
