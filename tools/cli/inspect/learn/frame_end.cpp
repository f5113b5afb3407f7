#include "tools/cli/inspect/learn/frame_end.hpp"

#include <algorithm>

#include "tools/cli/inspect/learn/field_layout.hpp"

namespace fieldcast::learn {

using declared::FieldKind;

FrameEnd end_of(const Frames& frames, const std::optional<FoundChecksum>& common, bool text) {
  FrameEnd end;
  Evidence fits{0, frames.size()};
  for (const ByteView frame : frames) fits.holds += common && common->fits(frame) ? 1 : 0;
  end.check = common && fits.holds_mostly() ? common : find_checksum(frames, text);
  if (end.check) {
    if (common && fits.holds_mostly()) end.check->evidence = fits;
    end.size = end.check->end_size();
    return end;
  }
  if (shortest(frames) == longest(frames) && !text) return end;
  // Marks behind the data; letters and digits belong to the data.
  const std::size_t most = constant_end(frames, 4);
  while (end.size < most) {
    const auto c = *constant_at(frames, -1 - static_cast<std::ptrdiff_t>(end.size));
    if (text && (c >= ' ' && c <= '~')) break;
    ++end.size;
  }
  return end;
}

std::vector<LearnedField> with_end(std::vector<LearnedField> fields, const FrameEnd& end,
                                   const Frames& frames, const LengthSpans& spans) {
  const std::size_t before_end = fields.size();
  if (!end.check && spans.empty() && end.size > 0 && before_end > 0 &&
      fields.back().kind == FieldKind::kConstant && fields.back().width < 60) {
    const LearnedField rest =
        constant_field(frames, -static_cast<std::ptrdiff_t>(end.size), end.size);
    append(fields.back().constant, rest.constant);
    fields.back().width += rest.width;
    name_fields(fields);
    return fields;
  }
  const auto add_constant = [&](std::size_t from_end, std::size_t width) {
    if (width > 0)
      fields.push_back(constant_field(frames, -static_cast<std::ptrdiff_t>(from_end), width));
  };
  std::size_t check_at = 0;
  if (end.check) {
    add_constant(end.size, end.check->gap);
    check_at = fields.size();
    LearnedField made{.kind = FieldKind::kChecksum, .width = end.check->word.characters};
    made.at = -static_cast<std::ptrdiff_t>(end.check->word.characters + end.check->trailer);
    made.word = end.check->word;
    made.check_kind = end.check->kind;
    made.check = end.check->check;
    made.evidence = end.check->evidence;
    fields.push_back(std::move(made));
    add_constant(end.check->trailer, end.check->trailer);
  } else {
    add_constant(end.size, end.size);
  }
  name_fields(fields);
  const auto name_from = [&](std::ptrdiff_t at) {
    const auto found = std::ranges::find_if(
        fields, [&](const LearnedField& each) { return each.at >= at && at >= 0; });
    return found == fields.end() ? std::string() : found->name;
  };
  for (LearnedField& each : fields) {
    for (const auto& [at, from] : spans) {
      if (each.kind != FieldKind::kLength || each.at != at) continue;
      each.of_first = name_from(from);
      if (before_end > 0) each.of_last = fields[before_end - 1].name;
      if (each.of_first.empty() || each.of_last.empty())
        each.kind = FieldKind::kUnused, each.plus = 0;
    }
  }
  if (end.check && before_end > 0) {
    fields[check_at].of_first = name_from(static_cast<std::ptrdiff_t>(end.check->from));
    fields[check_at].of_last = fields[before_end - 1].name;
  }
  return fields;
}

}  // namespace fieldcast::learn
