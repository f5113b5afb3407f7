#include <algorithm>
#include <array>

#include "core/protocol/declared/frame.hpp"
#include "core/protocol/declared/scaled.hpp"

namespace fieldcast::declared {
namespace {

// REQUIRES: bytes.size() >= text.size().
bool begins_with(ByteView bytes, std::string_view text) {
  return std::equal(text.begin(), text.end(), bytes.begin(),
                    [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
}

class Matcher {
 public:
  Matcher(const Frame& frame, ByteView bytes, const FrameContext& context, std::size_t record_items)
      : fields_(frame.fields),
        frame_(frame),
        bytes_(bytes),
        context_(context),
        record_(2 * record_items) {}

  MatchResult run() {
    for (at_ = 0; at_ < fields_.size(); ++at_) {
      starts_[at_] = offset_;
      if (frame_.escape != Escape::kNone && at_ == frame_.escaped.from && !unescape_here())
        return std::move(result_);
      if (!step(fields_[at_])) return std::move(result_);
    }
    starts_[at_] = offset_;
    result_.fit = MatchResult::Fit::kWhole;
    result_.size = offset_ + escapes_;
    for (const Field& field : fields_) {
      if (field.kind == FieldKind::kChecksum) check(field);
    }
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      if (fields_[i].scaled()) scale(i);
    }
    if (result_.items.empty()) result_.items = std::move(record_);
    return std::move(result_);
  }

 private:
  bool unescape_here() {
    const auto read = unescape_from(frame_, offset_, bytes_, plain_);
    if (!read) return none();
    escapes_ = read->used - read->plain.size();
    bytes_ = plain_;
    return true;
  }

  // Returns false if the result is known.
  bool step(const Field& field) {
    meant_.clear();
    if (field.transform) meant_ = field.transform.meant(bytes_.subspan(offset_));
    transformed_ = static_cast<bool>(field.transform);
    if (field.kind == FieldKind::kItems)
      return field.separator.empty() ? items(field) : separated_items(field);
    if (!field.key.empty()) return block();
    if (field.text_size != 0) return text_value(field);
    if (!field.text.empty()) return text_constant(field);
    if (field.opens && !open(field)) return false;
    return number(field, word_ >> field.shift & (UINT64_MAX >> (64 - field.bits)));
  }

  bool none() {
    result_.fit = MatchResult::Fit::kNone;
    return false;
  }
  bool part() {
    const std::size_t whole =
        offset_ + size_of(frame_, at_, fields_.size(), context_.item_bits, context_.count);
    result_.fit = MatchResult::Fit::kPart;
    result_.missing = std::max<std::size_t>(1, whole - std::min(whole - 1, bytes_.size()));
    return false;
  }
  bool lacks(std::size_t characters) const { return bytes_.size() - offset_ < characters; }
  // Bytes from the field on, without its transform.
  ByteView rest() const { return transformed_ ? ByteView(meant_) : bytes_.subspan(offset_); }

  bool open(const Field& field) {
    width_ = width_of(rest(), field.word);
    if (lacks(width_ + (field.word.variable ? 1 : 0))) return begins(field) ? part() : none();
    const auto word = read_word(rest().first(width_), field.word);
    if (!word) return none();
    word_ = *word;
    // Decimal digits can exceed the bits of their fields.
    if (word_ >> 1 >> (bits_of_word(field) - 1) != 0) return none();
    return true;
  }
  static unsigned bits_of_word(const Field& field) {
    if (field.word.notation == Notation::kHex) return field.word.characters * 4u;
    return field.word.notation == Notation::kBinary ? field.word.characters * 8u : 64u;
  }
  bool begins(const Field& field) const {
    if (field.word.variable) return rest().size() <= most_characters(field.word);
    if (!could_begin(rest(), field.word)) return false;
    const bool fixed = field.kind == FieldKind::kConstant || field.kind == FieldKind::kCommand;
    if (!fixed || field.bits != bits_of_word(field)) return true;
    Bytes right;
    append_word(right, field.word, *number_of(field, context_));
    return std::equal(rest().begin(), rest().end(), right.begin());
  }

  bool number(const Field& field, std::uint64_t number) {
    const auto right = number_of(field, context_);
    const bool equal = right && *right == number;
    switch (field.kind) {
      case FieldKind::kConstant:
      case FieldKind::kCommand:
        if (!equal) return none();
        ++result_.known;
        break;
      case FieldKind::kAddress:
      case FieldKind::kSequence: result_.foreign |= !equal; break;
      case FieldKind::kFirst:
      case FieldKind::kCount:
      case FieldKind::kLast: result_.mismatch |= !equal; break;
      case FieldKind::kLength:
        if (!length(field, number)) return none();
        break;
      case FieldKind::kError:
        if (context_.refusal == (number == field.number)) return none();
        result_.error = static_cast<std::uint16_t>(number);
        break;
      case FieldKind::kValue:
        if (!field.scaled()) value(field, number);
        break;
      case FieldKind::kRate:
        result_.rate = number;
        result_.mismatch |= !field.rates.empty() && !field.rates.contains(number);
        break;
      default: break;
    }
    if (at_ + 1 == fields_.size() || fields_[at_ + 1].opens) offset_ += width_;
    return true;
  }

  // An unexpected length is followed, so that its frame is skipped as a whole.
  bool length(const Field& field, std::uint64_t number) {
    std::int64_t left = static_cast<std::int64_t>(number & 0x7FFFFFFFu) - field.plus;
    std::int64_t expected = 0;
    const Field* elastic = nullptr;
    for (std::size_t i = field.of.from; i <= field.of.to; ++i) {
      if (!fields_[i].key.empty() && !opens_block(frame_, i)) continue;
      const auto size = size_of(frame_, i, i + 1, context_.item_bits, context_.count);
      const bool soft =
          i > at_ && (fields_[i].kind == FieldKind::kItems ||
                      (fields_[i].variable && fields_[i].text.empty()) || !fields_[i].key.empty());
      expected = static_cast<std::int64_t>(counted(fields_[i], field, size, context_.item_bits));
      if (soft)
        elastic = &fields_[i], elastic_at_ = i;
      else
        left -= expected;
    }
    if (elastic == nullptr) {
      result_.mismatch |= left != 0;
      return true;
    }
    if (left < 0 || left > static_cast<std::int64_t>(kMaxFrame)) return false;
    const auto given =
        characters_of_count(*elastic, field, static_cast<std::uint64_t>(left), context_.item_bits);
    if (given_size_ && *given_size_ != given) return false;  // two lengths that contradict
    given_size_ = given;
    return true;
  }
  std::optional<std::size_t> given_size() const {
    return given_size_ && elastic_at_ == at_ ? given_size_ : std::nullopt;
  }

  bool items(const Field& field) {
    const std::size_t expected = items_size(field, context_.item_bits, context_.count);
    const std::size_t size = given_size().value_or(expected);
    if (size == 0 || size > kMaxFrame) return none();
    result_.mismatch |= size != expected;
    if (lacks(size)) {
      if (!could_begin_items(field)) return none();
      part();
      result_.missing += size > expected ? size - expected : 0;
      return false;
    }
    if (size == expected) {
      auto items = read_items(rest().first(size), field, context_.item_bits, context_.count);
      if (!items) return none();
      result_.mismatch |= context_.written && *items != context_.items;
      result_.items = std::move(*items);
    }
    offset_ += size;
    return true;
  }
  bool could_begin_items(const Field& field) const { return could_begin(rest(), field.word); }

  // Items between separators; a number of variable width ends at the first other character.
  bool separated_items(const Field& field) {
    if (context_.count == 0) return none();
    ByteView left = rest();
    Bytes items;
    for (std::uint32_t i = 0; i < context_.count; ++i) {
      const std::string_view separator = i == 0 ? std::string_view{} : field.separator;
      const std::size_t given = std::min(separator.size(), left.size());
      if (!begins_with(left, separator.substr(0, given))) return none();
      left = left.subspan(given);
      const std::size_t width = width_of(left, field.word);
      if (given < separator.size() || left.size() < width + (field.word.variable ? 1 : 0)) {
        const bool fits = field.word.variable ? left.size() <= most_characters(field.word)
                                              : could_begin(left, field.word);
        return fits ? part() : none();
      }
      const auto item = read_items(left.first(width), field, context_.item_bits, 1);
      if (!item || item->empty()) return none();
      append(items, *item);
      left = left.subspan(width);
    }
    result_.mismatch |= context_.written && items != context_.items;
    result_.items = std::move(items);
    offset_ = bytes_.size() - left.size();
    return true;
  }

  // An optional constant is absent if other characters follow, or if the frame can end before it.
  bool is_absent(const Field& field) const {
    const std::size_t size = std::min(field.text.size(), rest().size());
    if (size == 0) {
      return std::all_of(fields_.begin() + static_cast<std::ptrdiff_t>(at_), fields_.end(),
                         [](const Field& each) { return !each.text.empty() && each.variable; });
    }
    return !begins_with(rest(), std::string_view(field.text).substr(0, size));
  }

  // A constant, or an address that is text.
  bool text_constant(const Field& field) {
    if (field.variable && is_absent(field)) return true;
    const std::size_t size = std::min(field.text.size(), rest().size());
    if (!begins_with(rest(), std::string_view(field.text).substr(0, size))) {
      if (field.kind != FieldKind::kAddress) return none();
      result_.foreign = true;
    }
    if (size < field.text.size()) return part();
    ++result_.known;
    offset_ += size;
    return true;
  }

  bool text_value(const Field& field) {
    std::size_t size = field.text_size;
    if (field.variable) {
      if (const auto stated = given_size()) {
        size = *stated;
      } else {
        const std::size_t at_mark = *mark_behind(frame_, at_);
        const Bytes mark = mark_as_read(field, fields_[at_mark]);
        const std::size_t between = size_of(frame_, at_ + 1, at_mark, context_.item_bits, 0);
        const auto from = rest().subspan(std::min(between, rest().size()));
        const auto end = std::search(from.begin(), from.end(), mark.begin(), mark.end());
        size = static_cast<std::size_t>(end - from.begin());
        if (end == from.end() && size < field.text_size + mark.size()) {
          part();
          result_.missing = 1;
          return false;
        }
      }
      if (size > field.text_size) return none();
    }
    if (lacks(size)) return part();
    const std::size_t from = 2u * field.place;
    for (std::size_t i = 0; field.kind == FieldKind::kValue && !field.scaled() && i < size &&
                            from + i < record_.size();
         ++i)
      record_[from + i] = rest()[i];
    offset_ += size;
    return true;
  }
  // All fields of a block; it ends as a length field says, or at the constant behind it.
  bool block() {
    const std::size_t end = block_end(frame_, at_);
    std::optional<std::size_t> size = given_size();
    if (!size) {
      const Bytes mark = constant_characters(fields_[end]);
      const auto found = std::search(rest().begin(), rest().end(), mark.begin(), mark.end());
      if (found == rest().end() && rest().size() <= kMaxFrame) {
        part();
        result_.missing = mark.size();
        return false;
      }
      size = static_cast<std::size_t>(found - rest().begin());
    }
    if (*size > kMaxFrame) return none();
    if (lacks(*size)) {
      part();
      result_.missing = offset_ + *size - bytes_.size();
      return false;
    }
    const ByteView content = rest().first(*size);
    offset_ += *size;
    for (; at_ < end; ++at_) {
      if (at_ + 1 < end) starts_[at_ + 1] = offset_;
      if (fields_[at_].kind == FieldKind::kValue) block_value(content, fields_[at_]);
    }
    --at_;
    return true;
  }

  void block_value(ByteView content, const Field& field) {
    const auto found = value_in_block(frame_, at_, content);
    const auto number =
        found && field.text_size == 0 ? read_word(*found, field.word) : std::nullopt;
    if (number) return value(field, *number & (UINT64_MAX >> (64 - field.bits)));
    if (!found || field.text_size == 0) {
      result_.absent.push_back({.first = field.place, .count = items_of(field)});
      return;
    }
    const std::size_t from = 2u * field.place;
    for (std::size_t i = 0; i < found->size() && from + i < record_.size(); ++i)
      record_[from + i] = (*found)[i];
  }

  // The characters of the constant, as they would be read in `field`.
  static Bytes mark_as_read(const Field& field, const Field& constant) {
    Bytes mark = constant_characters(constant);
    for (std::uint8_t& each : mark) each = field.transform.meant(constant.transform.sent(each));
    return mark;
  }

  void value(const Field& field, std::uint64_t number) {
    const std::size_t items = items_of(field);
    const bool negative = field.is_signed && (number >> (field.bits - 1) & 1u) != 0;
    if (negative && field.bits < 64) number |= UINT64_MAX << field.bits;
    const std::size_t from = 2u * field.place, width = 2u * items;
    for (std::size_t i = 0; i < width && from + i < record_.size(); ++i)
      record_[from + i] = static_cast<std::uint8_t>(number >> 8 * (width - 1 - i));
    if (!context_.written || field.place < context_.first ||
        field.place + items > context_.first + context_.count)
      return;
    const auto sent = value_in(context_.items, field.place - context_.first, items);
    result_.mismatch |= ((sent ^ number) & (UINT64_MAX >> (64 - field.bits))) != 0;
  }

  // A value without digits leaves its place empty, so that its channels are out of range.
  void scale(std::size_t at) {
    const Field& field = fields_[at];
    const auto decimal = scaled_value(frame_, at, bytes_, starts_);
    const std::string text = decimal ? to_text(*decimal) : "";
    const std::size_t from = 2u * field.place;
    for (std::size_t i = 0; i < text.size() && from + i < record_.size(); ++i)
      record_[from + i] = static_cast<std::uint8_t>(text[i]);
    if (!context_.written || field.place < context_.first ||
        field.place + items_of(field) > context_.first + context_.count)
      return;
    const auto sent =
        ByteView(context_.items).subspan(2 * (field.place - context_.first), kScaledCharacters);
    const auto asked = decimal_from({reinterpret_cast<const char*>(sent.data()), sent.size()});
    result_.mismatch |= !decimal || !asked || !asked->rounds_to(*decimal);
  }

  void check(const Field& field) {
    result_.checked = true;
    const std::size_t at = starts_[static_cast<std::size_t>(&field - fields_.data())];
    const auto stated =
        read_word(field.transform.meant(bytes_.subspan(at, field.word.characters)), field.word);
    result_.bad_check |=
        stated != check_of(field.check, field.bits, covered(frame_, field, bytes_, starts_));
  }

  const std::vector<Field>& fields_;
  const Frame& frame_;
  ByteView bytes_;  // from the escaped fields on: plain_
  Bytes plain_;
  std::size_t escapes_ = 0;  // characters that the escaped fields have more
  const FrameContext& context_;
  Bytes record_;
  Bytes meant_;  // with transformed_: see rest()
  bool transformed_ = false;
  MatchResult result_;
  std::array<std::size_t, kMaxFields + 1> starts_{};
  std::size_t at_ = 0;                     // index of the field
  std::size_t offset_ = 0;                 // of its first character
  std::uint64_t word_ = 0;                 // contains the field
  std::size_t width_ = 0;                  // characters of word_
  std::optional<std::size_t> given_size_;  // characters of the field, from its length field
  std::size_t elastic_at_ = 0;
};

}  // namespace

MatchResult match_frame(const Frame& frame, ByteView bytes, const FrameContext& context,
                        std::size_t record_items) {
  if (frame.fields.empty()) return {};  // the response to a write that has none
  return Matcher(frame, bytes, context, record_items).run();
}

}  // namespace fieldcast::declared
