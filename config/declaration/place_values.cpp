// Sets the offset of every value in its record.
#include <fmt/format.h>

#include <algorithm>

#include "config/declaration/declared_frame.hpp"
#include "config/document/suggest.hpp"
#include "core/protocol/declared/frame.hpp"

namespace fieldcast::config {
namespace {

using declared::Declaration;
using declared::DeclaredArea;
using declared::Field;
using declared::FieldKind;

// The response of a read defines the places.
class Placing {
 public:
  Placing(Declaration& declaration, FaultList& faults)
      : declaration_(declaration), faults_(faults) {}

  void define(DraftOperation& draft) {
    DeclaredArea& area = declaration_.areas[draft.operation.area];
    if (!area.places.empty()) {
      faults_.add(draft.position, fmt::format("the record '{}' is read twice", area.name),
                  "one operation that reads it");
      draft.good = false;
      return;
    }
    define(draft.response, area);
    for (DraftFrame& other : draft.others) {
      // Forms share the places of values with the same name.
      for (DraftField& field : other.fields) {
        field.placed = field.field.kind == FieldKind::kValue && has_place(area, field.field);
        if (field.placed) find(area, field);
      }
      define(other, area);
    }
  }

  void resolve(DraftOperation& draft) {
    DeclaredArea& area = declaration_.areas[draft.operation.area];
    std::uint32_t low = UINT32_MAX, high = 0, sum = 0;
    for (DraftFrame* frame : {&draft.request, &draft.response}) {
      for (DraftField& field : frame->fields) {
        if (field.field.kind != FieldKind::kValue || !find(area, field)) continue;
        if (frame != &draft.request) continue;
        const std::uint32_t items = declared::items_of(field.field);
        low = std::min<std::uint32_t>(low, field.field.place);
        high = std::max(high, field.field.place + items);
        sum += items;
      }
    }
    if (sum == 0) return;
    if (high - low != sum)
      faults_.add(draft.request.position,
                  "the values of a write do not follow each other in the record",
                  "neighbours, or a write for each");
    draft.operation.first = static_cast<std::uint16_t>(low);
    draft.operation.min_count = draft.operation.max_count = static_cast<std::uint16_t>(high - low);
  }

 private:
  static bool has_place(const DeclaredArea& area, const Field& field) {
    return std::ranges::find(area.places, field.name, &declared::Place::name) != area.places.end();
  }

  static declared::Place place_of(const Field& field) {
    declared::Place place{.name = field.name,
                          .first = field.place,
                          .items = declared::items_of(field),
                          .bits = field.text_size != 0 ? std::uint8_t{0} : field.bits,
                          .is_signed = field.is_signed,
                          .characters = field.text_size,
                          .text_number = field.text_number};
    if (!field.scaled()) return place;
    place.bits = 0;
    place.is_signed = false;
    place.characters = declared::kScaledCharacters;
    place.text_number = {.kind = TextNumber::Kind::kDecimal};
    place.scaled = true;
    return place;
  }

  void define(DraftFrame& frame, DeclaredArea& area) {
    for (DraftField& field : frame.fields) {
      if (field.field.kind != FieldKind::kValue || field.placed) continue;
      const auto items = declared::items_of(field.field);
      for (const auto& other : declaration_.areas) {
        if (std::ranges::find(other.places, field.field.name, &declared::Place::name) !=
            other.places.end())
          faults_.add(field.position, fmt::format("value '{}' exists already", field.field.name),
                      "names that occur once");
      }
      field.field.place = static_cast<std::uint16_t>(area.items);
      area.places.push_back(place_of(field.field));
      area.items += items;
    }
  }

  bool find(const DeclaredArea& area, DraftField& draft) {
    std::vector<std::string_view> names;
    for (const auto& place : area.places) names.push_back(place.name);
    const auto place = std::ranges::find(area.places, draft.field.name, &declared::Place::name);
    if (place == area.places.end()) {
      faults_.add(draft.position,
                  fmt::format("no response contains a value '{}'", draft.field.name), joined(names),
                  closest(draft.field.name, names));
      return false;
    }
    if (draft.field.scaled() != place->scaled) {
      faults_.add(draft.position,
                  place->scaled
                      ? fmt::format("value '{}' has no exponent, decimals or sign here, but in the "
                                    "response that contains it",
                                    draft.field.name)
                      : fmt::format("value '{}' has an exponent, decimals or a sign here, but not "
                                    "in the response that contains it",
                                    draft.field.name),
                  "both, or none");
      return false;
    }
    if (place->scaled) {
      draft.field.place = place->first;
      return true;
    }
    const unsigned bits = draft.field.text_size != 0 ? 0u : draft.field.bits;
    if (bits != place->bits || declared::items_of(draft.field) != place->items) {
      faults_.add(
          draft.position,
          fmt::format("value '{}' has a different width than in the response that contains it",
                      draft.field.name),
          bits == 0 || place->bits == 0 ? fmt::format("text: {}", place->characters)
                                        : fmt::format("{} bits", place->bits));
      return false;
    }
    if (draft.field.text_number && draft.field.text_number != place->text_number) {
      faults_.add(draft.position,
                  fmt::format("value '{}' is written in another form than in the response that "
                              "contains it",
                              draft.field.name),
                  "the same text in both");
      return false;
    }
    draft.field.place = place->first;
    return true;
  }

  Declaration& declaration_;
  FaultList& faults_;
};

}  // namespace

void place_values(Declaration& declaration, std::vector<DraftOperation>& operations,
                  FaultList& faults) {
  Placing placing(declaration, faults);
  const auto of_record = [&](const DraftOperation& draft) {
    return draft.good && declaration.areas[draft.operation.area].record;
  };
  for (auto& draft : operations) {
    if (of_record(draft) && !draft.operation.write) placing.define(draft);
  }
  for (auto& draft : operations) {
    if (of_record(draft) && draft.operation.write && draft.request.good && draft.response.good)
      placing.resolve(draft);
  }
}

}  // namespace fieldcast::config
