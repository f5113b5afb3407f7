#include <algorithm>

#include "core/protocol/declared/declaration.hpp"
#include "core/protocol/declared/frame.hpp"

namespace fieldcast::declared {
namespace {

// The constant at the end of a frame; empty if it ends otherwise.
Bytes end_mark(const Frame& frame) {
  const Field& last = frame.fields.back();
  const bool constant = last.kind == FieldKind::kConstant && !last.variable && last.bits % 8 == 0;
  return constant ? constant_characters(last) : Bytes{};
}

}  // namespace

// A frame without a checksum must begin at a boundary: otherwise the rest of a frame whose
// beginning is missing could be read as a whole one.
UnsolicitedFrame find_unsolicited(const Declaration& declaration, std::uint64_t address,
                                  ByteView bytes, bool boundary) {
  std::vector<Bytes> marks;
  for (const Operation& operation : declaration.operations) {
    if (operation.unsolicited > Duration::zero()) marks.push_back(end_mark(operation.response));
  }
  const auto ends_frame = [&](std::size_t at) {
    if (at == 0) return boundary;
    return std::ranges::any_of(marks, [&](const Bytes& mark) {
      return !mark.empty() && at >= mark.size() &&
             std::ranges::equal(mark, bytes.subspan(at - mark.size(), mark.size()));
    });
  };
  std::optional<std::size_t> begun;  // where an incomplete frame may begin
  bool begun_at_boundary = false;
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    const bool at_boundary = ends_frame(at);
    for (const Operation& operation : declaration.operations) {
      if (operation.unsolicited == Duration::zero()) continue;
      const DeclaredArea& area = declaration.areas[operation.area];
      const FrameContext context{
          .address = address, .command = operation.command, .item_bits = area.item_bits};
      MatchResult result = match_frame(operation.response, bytes.subspan(at), context, area.items);
      if (result.fit == MatchResult::Fit::kNone || result.foreign || result.mismatch) continue;
      if (result.fit == MatchResult::Fit::kPart) {
        if (!begun) begun = at, begun_at_boundary = at_boundary;
        continue;
      }
      if (result.bad_check || (!result.checked && (!at_boundary || begun_at_boundary))) continue;
      for (Range& items : result.absent) items.area = operation.area;
      return {.used = at + result.size,
              .boundary = true,
              .range = Range{operation.area, 0, area.items},
              .items = std::move(result.items),
              .absent = std::move(result.absent)};
    }
  }
  // A later search needs the incomplete frame, and the end mark that may begin before it.
  std::size_t used = begun.value_or(bytes.size()), longest = 1;
  for (const Bytes& mark : marks) longest = std::max(longest, mark.size());
  if (!ends_frame(used)) used -= std::min(used, longest - 1);
  return {.used = used, .boundary = ends_frame(used)};
}

}  // namespace fieldcast::declared
