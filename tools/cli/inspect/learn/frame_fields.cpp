#include "tools/cli/inspect/learn/frame_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace fieldcast::learn {

using declared::FieldKind;

namespace {

// What nearly all frames have there.
LearnedField constant_in(const Frames& frames, std::ptrdiff_t at, std::size_t width) {
  Bytes bytes;
  for (std::size_t i = 0; i < width; ++i)
    bytes.push_back(constant_at(frames, at + static_cast<std::ptrdiff_t>(i)).value_or(0));
  LearnedField field = constant_field(bytes, at);
  field.evidence = {};
  for (const ByteView frame : frames)
    field.evidence.add(std::ranges::equal(columns_of(frame, at, width), bytes));
  return field;
}

// Whether the field is bytes in two hexadecimal digits each; a constant becomes a number.
bool as_pairs(LearnedField& field) {
  if (field.kind == FieldKind::kConstant && field.width <= 14 &&
      are_digits({field.constant}, 0, 0, 16))
    field.word = digits(declared::Notation::kHex, field.width);
  const std::size_t size = field.width != 0 ? field.width : field.word.characters;
  return field.word.notation == declared::Notation::kHex && size % 2 == 0;
}

}  // namespace

LearnedField constant_field(ByteView bytes, std::ptrdiff_t at) {
  LearnedField field{.kind = FieldKind::kConstant, .at = at, .width = bytes.size()};
  field.constant.assign(bytes.begin(), bytes.end());
  return field;
}

FrameFields::FrameFields(const Frames& frames, const std::optional<FoundChecksum>& common,
                         bool text)
    : frames_(frames), text_(text) {
  set_end(common);
  const std::size_t room = shortest(frames);
  limit_ = static_cast<std::ptrdiff_t>(room - std::min(room, end_size_));
  if (check_) covered_.insert(static_cast<std::ptrdiff_t>(check_->from));
}

void FrameFields::set_end(const std::optional<FoundChecksum>& common) {
  Evidence fits;
  for (const ByteView frame : frames_) fits.add(common && common->fits(frame));
  check_ = fits.holds_mostly() ? common : find_checksum(frames_, text_);
  if (check_) {
    if (fits.holds_mostly()) check_->evidence = fits;
    end_size_ = check_->end_size();
    if (!text_ || check_->gap > 0) return;
  }
  if (shortest(frames_) == longest(frames_) && !text_) return;
  // Marks behind the data; letters and digits belong to the data.
  for (; marks_ < 4; ++marks_, ++end_size_) {
    const auto c = constant_at(frames_, -1 - static_cast<std::ptrdiff_t>(end_size_));
    if (end_size_ >= shortest(frames_) || !c || (text_ && *c >= ' ' && *c <= '~')) return;
  }
}

bool FrameFields::is_free(std::ptrdiff_t at, std::size_t width) const {
  const auto end = at + static_cast<std::ptrdiff_t>(width);
  return at >= 0 && end <= limit_ &&
         std::ranges::none_of(
             fields_,
             [&](const LearnedField& field) { return field.at < end && at < field.end(); }) &&
         std::ranges::none_of(covered_, [&](auto from) { return from > at && from < end; });
}

bool FrameFields::add(LearnedField field) {
  std::ptrdiff_t end = field.end();
  if (field.width > 0 && check_ && check_->align(field.at, end)) {
    field.width = static_cast<std::size_t>(end - field.at);
    if (field.word.notation == declared::Notation::kDecimal) field.note.clear();
    field.word = digits(declared::Notation::kHex, field.width);
  }
  if (field.width == 0 || !is_free(field.at, field.width)) return false;
  fields_.push_back(field);
  if (field.from >= 0) covered_.insert(field.from);
  return true;
}

std::ptrdiff_t FrameFields::used() const {
  std::ptrdiff_t end = covered_.empty() ? 0 : *covered_.rbegin();
  for (const LearnedField& field : fields_) end = std::max(end, field.end());
  return end;
}

void FrameFields::fill(FieldKind others, const std::string& note) {
  const auto varies = [&](std::ptrdiff_t column) {
    std::ptrdiff_t end = column + 1;
    if (check_) check_->align(column, end);
    return !constant_at(frames_, column) || !constant_at(frames_, end - 1);
  };
  for (std::ptrdiff_t at = 0; at < limit_; ++at) {
    if (!is_free(at, 1)) continue;
    const bool varying = varies(at);
    std::ptrdiff_t end = at + 1;
    while (end - at < (varying ? 8 : 64) && is_free(at, static_cast<std::size_t>(end - at) + 1) &&
           varies(end) == varying)
      ++end;
    LearnedField field = constant_in(frames_, at, static_cast<std::size_t>(end - at));
    if (varying) {
      field.kind = others;
      field.evidence.holds = field.evidence.of;
      field.note = note;
      field.word = text_ ? digits(declared::Notation::kHex, field.width) : binary(field.width);
      if (text_ && !are_digits(frames_, at, end, 16))
        field.word = {}, field.options = fmt::format(", text: {}", field.width);
    }
    fields_.push_back(std::move(field));
  }
}

void FrameFields::add_constant(std::size_t from_end, std::size_t width) {
  if (width > 0)
    fields_.push_back(constant_in(frames_, -static_cast<std::ptrdiff_t>(from_end), width));
}

void FrameFields::add_end() {
  add_constant(check_->end_size(), check_->gap);
  LearnedField made{.kind = FieldKind::kChecksum, .at = check_->at(), .word = check_->word};
  made.width = check_->word.characters;
  made.options = fmt::format(", kind: {}", check_->kind);
  if (check_->check.complement == declared::Complement::kOnes) made.options += ", complement: ones";
  made.pairs = check_->check.over_bytes;
  if (made.pairs) made.options += ", over: bytes";
  made.from = static_cast<std::ptrdiff_t>(check_->from);
  made.evidence = check_->evidence;
  fields_.push_back(std::move(made));
  add_constant(check_->trailer, check_->trailer);
}

std::vector<LearnedField> FrameFields::finish(unsigned& values) {
  std::ranges::stable_sort(fields_, {}, &LearnedField::at);
  if (check_) add_constant(end_size_, marks_);
  const std::size_t count = fields_.size();
  check_ ? add_end() : add_constant(end_size_, marks_);
  std::map<FieldKind, unsigned> counts;
  for (LearnedField& field : fields_) {
    const bool value = field.kind == FieldKind::kValue;
    const unsigned number = value ? ++values : ++counts[field.kind];
    field.name =
        std::string(to_text(field.kind)) + (number > 1 || value ? fmt::format("-{}", number) : "");
  }
  for (LearnedField& field : fields_) {
    if (field.from < 0) continue;
    const auto end = fields_.begin() + static_cast<std::ptrdiff_t>(count);
    const auto first = std::find_if(
        fields_.begin(), end, [&](const LearnedField& each) { return each.at == field.from; });
    if (first == end || (field.pairs && !std::all_of(first, end, as_pairs))) {
      // Nothing between it and the end, within a value, or a text.
      field.kind = FieldKind::kUnused, field.plus = 0, field.options.clear();
      field.note = "what it covers is unknown";
    } else {
      field.of = first->name + (first + 1 == end ? "" : ".." + (end - 1)->name);
    }
  }
  return std::move(fields_);
}

}  // namespace fieldcast::learn
