#include "tools/import/formats/list/list_vote.hpp"

#include <algorithm>
#include <tuple>
#include <utility>
#include <vector>

namespace fieldcast::importing {
namespace {

constexpr std::array kLengthUnits{LengthUnit::kWords, LengthUnit::kBytes, LengthUnit::kBits};
constexpr std::size_t kRowsNamed = 3;

}  // namespace

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

namespace {

enum class Say { kNothing, kConfirms, kContradicts, kIsNone };

// REQUIRES: is_voter(entry).
Say say_of(const ListEntry& entry) {
  const bool number = !entry.no_type && is_number(entry.type.type->type);
  if (!entry.address.is_open()) return Say::kIsNone;
  const ModbusArea area = *entry.address.reference->area;
  if (holds_bits(area) && number) return Say::kIsNone;
  if (!entry.said) return Say::kNothing;
  return *entry.said == area ? Say::kConfirms : Say::kContradicts;
}

bool is_voter(const ListEntry& entry) { return !entry.fault && entry.address.plain; }

}  // namespace

bool references_count_from_one(std::span<const ListEntry> entries) {
  std::vector<const ListEntry*> voters;
  for (const ListEntry& entry : entries) {
    if (is_voter(entry)) voters.push_back(&entry);
  }
  if (voters.empty()) return false;
  std::size_t confirm = 0, contradict = 0, confirmed_areas = 0;
  bool most_of_each = true;
  for (const ModbusArea area :
       {ModbusArea::kCoil, ModbusArea::kInput, ModbusArea::kInputRegister, ModbusArea::kHolding}) {
    const auto count = [&](Say say) {
      return static_cast<std::size_t>(std::ranges::count_if(voters, [&](const ListEntry* entry) {
        return say_of(*entry) == say && entry->address.reference->area == area;
      }));
    };
    const std::size_t yes = count(Say::kConfirms), no = count(Say::kContradicts);
    confirm += yes;
    contradict += no;
    confirmed_areas += yes > 0;
    most_of_each = most_of_each && (no == 0 || yes > no);
  }
  for (const ListEntry* entry : voters) {
    if (say_of(*entry) == Say::kIsNone) return false;
  }
  if (contradict == 0) return true;
  return confirm > contradict && (confirmed_areas >= 2 || most_of_each);
}

std::string note_of_references(std::span<const ListEntry> entries, const Columns& columns) {
  if (references_count_from_one(entries)) return {};
  const auto cell_of = [&](const ListEntry& entry) {
    return columns.cell(*entry.row, Field::kAddress);
  };
  const ListEntry* example = nullptr;
  std::string against;
  std::size_t count = 0;
  for (const ListEntry& entry : entries) {
    if (!is_voter(entry)) continue;
    const Say say = say_of(entry);
    if (say == Say::kNothing || say == Say::kConfirms) {
      if (example == nullptr) example = &entry;
      continue;
    }
    if (++count > kRowsNamed) continue;
    against += fmt::format("{}line {} ('{}'{})", against.empty() ? "" : ", ", entry.row->line,
                           cell_of(entry), say == Say::kContradicts ? " of another function" : "");
  }
  if (example == nullptr) return {};
  if (count > kRowsNamed) against += fmt::format(" and {} more", count - kRowsNamed);
  return fmt::format(
      "numbers such as '{}' (line {}) are taken as they are, not as references that count from 1, "
      "for this cannot be one: {}; if that row is wrong, take it out",
      cell_of(*example), example->row->line, against);
}

namespace {

bool same_table(const Placed& a, const Placed& b) {
  return a.device == b.device && a.area == b.area;
}

void note_both(const Placed& a, const Placed& b, std::string_view what) {
  for (const auto& [own, other] : {std::pair(&a, &b), std::pair(&b, &a)})
    own->point->changes.push_back(fmt::format("{} of '{}' (line {}) too", what, other->point->name,
                                              other->point->origin.line));
}

}  // namespace

void note_overlaps(std::vector<Placed> values) {
  std::ranges::stable_sort(values, {}, [](const Placed& value) {
    return std::tuple(value.device, value.area, value.bit.has_value(), value.first,
                      value.bit.value_or(0));
  });
  // The previous value with the highest end.
  const Placed* last = nullptr;
  for (const Placed& value : values) {
    if (last && (!same_table(*last, value) || last->bit.has_value() != value.bit.has_value()))
      last = nullptr;
    if (last && value.bit) {
      if (last->first == value.first && last->bit == value.bit)
        note_both(*last, value, "is the bit");
    } else if (last && last->first + last->registers > value.first) {
      if (last->first != value.first || last->registers != value.registers)
        note_both(*last, value, "lies on registers");
    }
    if (!last || value.bit || value.first + value.registers > last->first + last->registers)
      last = &value;
  }
}

}  // namespace fieldcast::importing
