#include "tools/import/formats/list/reference_vote.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace fieldcast::importing {
namespace {

constexpr std::size_t kRowsNamed = 3;

}  // namespace

ReferenceVote::Say ReferenceVote::say_of(const Row& row) {
  if (!row.reference || (holds_bits(*row.reference) && row.is_number)) return Say::kIsNone;
  if (!row.said) return Say::kNothing;
  return *row.said == *row.reference ? Say::kConfirms : Say::kContradicts;
}

bool ReferenceVote::counts_from_one() const {
  struct Area {
    std::size_t confirm = 0, contradict = 0;
  };
  std::array<Area, 4> areas;
  for (const Row& row : rows_) {
    const Say say = say_of(row);
    if (say == Say::kIsNone) return false;
    Area& area = areas[static_cast<std::size_t>(*row.reference)];
    area.confirm += say == Say::kConfirms;
    area.contradict += say == Say::kContradicts;
  }
  std::size_t confirm = 0, contradict = 0, confirmed_areas = 0;
  bool most_of_each = true;
  for (const Area& area : areas) {
    confirm += area.confirm;
    contradict += area.contradict;
    confirmed_areas += area.confirm > 0;
    most_of_each = most_of_each && (area.contradict == 0 || area.confirm > area.contradict);
  }
  if (contradict == 0) return !rows_.empty();
  return confirm > contradict && (confirmed_areas >= 2 || most_of_each);
}

std::string ReferenceVote::note() const {
  const auto example = std::ranges::find_if(rows_, [](const Row& row) {
    const Say say = say_of(row);
    return say == Say::kNothing || say == Say::kConfirms;
  });
  if (example == rows_.end() || counts_from_one()) return {};
  std::string against;
  std::size_t count = 0;
  for (const Row& row : rows_) {
    const Say say = say_of(row);
    if (say != Say::kContradicts && say != Say::kIsNone) continue;
    if (++count > kRowsNamed) continue;
    against += fmt::format("{}line {} ('{}'{})", against.empty() ? "" : ", ", row.line, row.cell,
                           say == Say::kContradicts ? " of another function" : "");
  }
  if (count > kRowsNamed) against += fmt::format(" and {} more", count - kRowsNamed);
  return fmt::format(
      "numbers such as '{}' (line {}) are taken as they are, not as references that count from 1, "
      "for this cannot be one: {}; if that row is wrong, take it out",
      example->cell, example->line, against);
}

}  // namespace fieldcast::importing
