// Checks refusals, and the rounds before a request.
#include <fmt/format.h>

#include <algorithm>

#include "config/declaration/declared_frame.hpp"
#include "core/protocol/declared/frame.hpp"

namespace fieldcast::config {

namespace {

using declared::Declaration;
using declared::DeclaredArea;
using declared::Field;
using declared::FieldKind;

void check_refusal_field(const Declaration& declaration, const DraftField& draft,
                         std::string_view what, FaultList& faults) {
  const auto kind = draft.field.kind;
  if (kind == FieldKind::kItems || kind == FieldKind::kValue || kind == FieldKind::kFirst ||
      kind == FieldKind::kCount || kind == FieldKind::kLast || kind == FieldKind::kRate ||
      declared::scales(draft.field))
    faults.add(draft.position, fmt::format("{} brings no '{}'", what, draft.field.name),
               "constant, address, command, error, length, sequence, checksum, unused");
  if (kind == FieldKind::kAddress && declaration.address_characters == 0 &&
      declaration.highest_address > declared::largest(draft.field.word))
    faults.add(draft.position,
               fmt::format("'{}' is too narrow: the address reaches {}", draft.field.name,
                           declaration.highest_address),
               "a wider field");
}

// Constants and commands distinguish frames of equal length.
std::vector<std::string> marks_of(const DraftFrame& frame) {
  std::vector<std::string> all;
  for (const auto& draft : frame.fields) {
    const Field& field = draft.field;
    if (field.kind == FieldKind::kConstant || field.kind == FieldKind::kCommand)
      all.push_back(fmt::format("{}/{}/{}", field.text, field.number, field.plus));
  }
  return all;
}

// Whether the refusal begins with hexadecimal codes whose first digit is a letter, and the response
// with decimal digits.
bool begins_with_letter(const Declaration& declaration, const DraftFrame& refusal,
                        const DraftFrame& response) {
  const Field &code = refusal.fields.front().field, &first = response.fields.front().field;
  const std::uint64_t lowest = std::uint64_t{0xA} << 4 * (code.word.characters - 1u);
  return first.word.notation == declared::Notation::kDecimal && first.text.empty() &&
         first.text_size == 0 && code.kind == FieldKind::kError &&
         code.word.notation == declared::Notation::kHex && !declaration.codes.empty() &&
         declaration.codes.begin()->first >= lowest;
}

bool are_distinct(const Declaration& declaration, const DraftFrame& refusal,
                  const DraftOperation& draft, const DraftFrame& response,
                  const DeclaredArea& area) {
  const auto size = declared::size_of(refusal.frame(), 16, 0);
  const auto response_size = [&](std::uint32_t count) {
    return declared::size_of(response.frame(), area.item_bits, count);
  };
  const bool variable = std::ranges::any_of(
      response.fields, [](const DraftField& each) { return each.field.word.variable; });
  return (!variable && size < response_size(draft.operation.min_count)) ||
         size > response_size(draft.operation.max_count) ||
         marks_of(refusal) != marks_of(response) || response.find(FieldKind::kError) != nullptr ||
         begins_with_letter(declaration, refusal, response);
}

}  // namespace

void check_forms(const DraftOperation& draft, const DeclaredArea& area, FaultList& faults) {
  const auto size = [&](const DraftFrame& form) {
    return declared::size_of(form.frame(), area.item_bits, 0);
  };
  std::vector<const DraftFrame*> known{&draft.response};
  for (const DraftFrame& form : draft.others) {
    for (const DraftFrame* earlier : known) {
      if (!form.good || !earlier->good || size(form) != size(*earlier) ||
          marks_of(form) != marks_of(*earlier))
        continue;
      faults.add(form.position,
                 "a form of the response cannot be distinguished from an earlier one",
                 "a different length, constant or command");
      break;
    }
    known.push_back(&form);
  }
}

void check_round(const Declaration& declaration, const DraftOperation& round, FaultList& faults) {
  for (const auto* frame : {&round.request, &round.response}) {
    for (const DraftField& draft : frame->fields) {
      if (draft.field.kind != FieldKind::kRate || frame == &round.request)
        check_refusal_field(declaration, draft, "a round before a request", faults);
      else if (draft.fits && draft.field.rates.empty())
        faults.add(draft.position,
                   fmt::format("'{}' does not say which baud rates there are", draft.field.name),
                   "rates: { 0x35: 9600, .. }");
      if (draft.field.kind == FieldKind::kCommand && !round.has_command)
        faults.add(draft.position, "a round has no command", "command: a number, in the round");
      if (draft.field.variable && draft.field.kind != FieldKind::kAddress &&
          frame == &round.request)
        faults.add(draft.position, "a variable text in a request",
                   "a fixed one: requests have one length");
    }
  }
}

void check_refusal(const Declaration& declaration, const std::vector<DraftOperation>& operations,
                   const DraftFrame& refusal, FaultList& faults) {
  if (refusal.fields.empty()) return;
  for (const DraftField& draft : refusal.fields)
    check_refusal_field(declaration, draft, "a refusal", faults);
  if (!refusal.good) return;
  for (const auto& draft : operations) {
    if (!draft.good || !draft.response.good) continue;
    const DeclaredArea& area = declaration.areas[draft.operation.area];
    const auto distinct = [&](const DraftFrame& response) {
      return !response.good || are_distinct(declaration, refusal, draft, response, area);
    };
    if (!distinct(draft.response) || !std::ranges::all_of(draft.others, distinct))
      faults.add(refusal.position,
                 fmt::format("a refusal cannot be distinguished from a response of '{}'",
                             draft.operation.name),
                 "a different length, constant or command, is: error in the response too, or "
                 "codes that begin with A to F before a decimal response");
  }
}

}  // namespace fieldcast::config
