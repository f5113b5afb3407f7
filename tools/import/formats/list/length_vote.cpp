#include "tools/import/formats/list/length_vote.hpp"

#include "tools/import/text/table.hpp"

namespace fieldcast::importing {
namespace {

constexpr std::array kLengthUnits{LengthUnit::kWords, LengthUnit::kBytes, LengthUnit::kBits};

}  // namespace

std::optional<LengthUnit> length_unit_of_title(std::string_view title) {
  const std::string word = column_word(title);
  const auto has = [&](std::string_view part) { return word.find(part) != std::string::npos; };
  if (has("byte")) return LengthUnit::kBytes;
  if (has("bits")) return LengthUnit::kBits;
  if (has("word") || has("reg")) return LengthUnit::kWords;
  return std::nullopt;
}

void LengthVote::add(Votes& votes, const Length& length, unsigned bits) {
  for (const LengthUnit unit : kLengthUnits) {
    if (length.unit.value_or(unit) == unit && length.bits(unit) == bits)
      ++votes[static_cast<std::size_t>(unit)];
  }
}

void LengthVote::add_type(const Length& length, unsigned bits) { add(by_type_, length, bits); }

void LengthVote::add_step(const Length& length, std::uint32_t step) {
  if (step <= 4) add(by_step_, length, step * 16);
}

std::optional<LengthUnit> LengthVote::most(const Votes& votes) {
  for (const LengthUnit unit : kLengthUnits) {
    const std::size_t own = votes[static_cast<std::size_t>(unit)];
    if (2 * own > votes[0] + votes[1] + votes[2]) return unit;
  }
  return std::nullopt;
}

std::optional<LengthUnit> LengthVote::unit() const {
  const auto by_type = most(by_type_);
  return by_type ? by_type : most(by_step_);
}

}  // namespace fieldcast::importing
