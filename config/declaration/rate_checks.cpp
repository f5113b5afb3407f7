// Checks the fields that change the baud rate of the response: the device names it in a round
// before the request, and the request repeats the code.
#include <fmt/format.h>

#include <algorithm>

#include "config/declaration/declared_frame.hpp"

namespace fieldcast::config {
namespace {

using declared::FieldKind;

std::ptrdiff_t rates_in(const declared::Frame& frame) {
  return std::ranges::count(frame.fields, FieldKind::kRate, &declared::Field::kind);
}

}  // namespace

void check_no_rate(const DraftFrame& frame, std::string_view what, FaultList& faults) {
  if (const DraftField* rate = frame.find(FieldKind::kRate))
    faults.add(rate->position, fmt::format("{} has a baud rate", what),
               "in the response of a round before a request, and in that request");
}

void check_named_rates(const DraftFrame& answer, FaultList& faults) {
  for (const DraftField& draft : answer.fields) {
    if (draft.fits && draft.field.kind == FieldKind::kRate && draft.field.rates.empty())
      faults.add(draft.position,
                 fmt::format("'{}' does not say which baud rates there are", draft.field.name),
                 "rates: { 0x35: 9600, .. }");
  }
}

void check_rates(const DraftOperation& draft, FaultList& faults) {
  check_no_rate(draft.response, "the response itself", faults);
  if (!draft.request.good) return;
  std::ptrdiff_t named = 0;
  for (const declared::Operation& round : draft.operation.before) named += rates_in(round.response);
  const std::ptrdiff_t repeated = rates_in(draft.request.frame());
  if (named == 0 && repeated == 0) return;
  const DraftField* field = draft.request.find(FieldKind::kRate);
  if (named != 1 || repeated != 1)
    faults.add(field == nullptr ? draft.request.position : field->position,
               fmt::format("a baud rate is named {} times and repeated {} times", named, repeated),
               "one field that is: rate in the rounds before the request, and one in the request");
  else if (!field->field.rates.empty())
    faults.add(field->position, "the request names baud rates",
               "is: rate alone, which repeats the code");
}

}  // namespace fieldcast::config
