// Determines the unit of a length column by types of known width, or else by the distances of
// consecutive addresses. Pure.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "tools/import/formats/list/list_type.hpp"

namespace fieldcast::importing {

// "Size (bytes)", "Number of registers", "Words", "Bits"; empty if the title has no unit.
[[nodiscard]] std::optional<LengthUnit> length_unit_of_title(std::string_view title);

class LengthVote {
 public:
  void add_type(const Length& length, unsigned bits);
  // Adds a value whose successor is `step` registers after it.
  void add_step(const Length& length, std::uint32_t step);
  // Empty without votes or in a tie.
  [[nodiscard]] std::optional<LengthUnit> unit() const;

 private:
  using Votes = std::array<std::size_t, 3>;  // by LengthUnit
  static void add(Votes& votes, const Length& length, unsigned bits);
  static std::optional<LengthUnit> most(const Votes& votes);

  Votes by_type_{}, by_step_{};
};

}  // namespace fieldcast::importing
