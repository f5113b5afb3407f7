#include <algorithm>

#include "core/protocol/declared/declaration.hpp"
#include "core/protocol/declared/frame.hpp"
#include "core/protocol/protocol_entry.hpp"

namespace fieldcast::declared {
namespace {

constexpr std::uint32_t kMostItemsTried = 64;  // of a write without a length field
// Fields with one possible value, in a frame without a check.
constexpr std::size_t kEnoughKnown = 2;

struct Seen {
  std::size_t size = 0;
  bool checked = false;
};

Seen match(const Declaration& declaration, const Operation& operation, const Frame& frame,
           ByteView bytes, bool refusal) {
  const DeclaredArea& area = declaration.areas[operation.area];
  FrameContext context;
  context.command = operation.command;
  context.item_bits = area.item_bits;
  context.refusal = refusal;
  // Without items the frame is the same for every count.
  const bool counts = std::ranges::any_of(
      frame.fields, [](const Field& field) { return field.kind == FieldKind::kItems; });
  const std::uint32_t most =
      counts ? std::min<std::uint32_t>(operation.max_count, kMostItemsTried) : operation.min_count;
  for (std::uint32_t count = operation.min_count; count <= most; ++count) {
    context.count = count;
    const MatchResult found = match_frame(frame, bytes, context, area.record ? area.items : 0);
    const bool plausible = found.checked ? !found.bad_check : found.known >= kEnoughKnown;
    if (found.fit == MatchResult::Fit::kWhole && plausible) return {found.size, found.checked};
  }
  return {};
}

}  // namespace

bool begins_checked_response(const Declaration& declaration, ByteView bytes) {
  return std::ranges::any_of(declaration.operations, [&](const Operation& operation) {
    const auto checked = [&](const Frame& frame, bool refusal) {
      return match(declaration, operation, frame, bytes, refusal).checked;
    };
    for (std::size_t n = 0; n <= operation.others.size(); ++n) {
      if (checked(operation.form(n), false)) return true;
    }
    return std::ranges::any_of(declaration.refusals,
                               [&](const Frame& refusal) { return checked(refusal, true); });
  });
}

SeenRequest seen_request(const Declaration& declaration, ByteView bytes) {
  SeenRequest seen;
  for (const Operation& operation : declaration.operations) {
    const Seen request = match(declaration, operation, operation.request, bytes, false);
    if (request.size == 0) continue;
    seen = {request.size, request.checked};
    break;
  }
  if (!seen) return seen;
  const ByteView frame = bytes.first(seen.size);
  for (const Operation& operation : declaration.operations) {
    const auto alike_frame = [&](const Frame& other, bool refusal) {
      return match(declaration, operation, other, frame, refusal).size == seen.size;
    };
    const bool alike =
        alike_frame(operation.response, false) ||
        std::ranges::any_of(operation.others,
                            [&](const Frame& other) { return alike_frame(other, false); }) ||
        std::ranges::any_of(declaration.refusals,
                            [&](const Frame& refusal) { return alike_frame(refusal, true); });
    if (alike) seen.certain = false;
  }
  return seen;
}

}  // namespace fieldcast::declared
