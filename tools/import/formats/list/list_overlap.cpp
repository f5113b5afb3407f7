#include "tools/import/formats/list/list_overlap.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <tuple>
#include <utility>

namespace fieldcast::importing {
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
