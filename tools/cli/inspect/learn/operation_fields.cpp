#include "tools/cli/inspect/learn/operation_fields.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tools/cli/inspect/learn/field_layout.hpp"
#include "tools/cli/inspect/learn/frame_end.hpp"

namespace fieldcast::learn {
namespace {

using declared::FieldKind;
using declared::Notation;

constexpr std::size_t kNeededPacked = 16;  // different bytes
constexpr std::uint64_t kMaxItem = 0xFE00'0000;

// A word of so many columns, decimal if no digit is above 9.
declared::Word word_at(const Frames& frames, std::ptrdiff_t at, std::size_t width, bool text) {
  if (!text) return binary(static_cast<unsigned>(std::min<std::size_t>(width, 8)));
  for (std::size_t i = 0; i < width; ++i) {
    if (!std::ranges::all_of(values_at(frames, at + static_cast<std::ptrdiff_t>(i)),
                             is_decimal_digit))
      return digits(Notation::kHex, std::min<std::size_t>(width, 16));
  }
  return digits(Notation::kDecimal, std::min<std::size_t>(width, 18));
}

class OperationBuilder {
 public:
  OperationBuilder(const Group& group, const Roles& roles, const Known& known)
      : group_(group), roles_(roles), known_(known), text_(roles.text) {
    out_.exchanges = group.requests.size();
    request_end_ = end_of(group_.requests, roles.request_check, text_);
    response_end_ = end_of(group_.responses, roles.response_check, text_);
  }

  LearnedOperation run() {
    if (!group_.requests.front().empty()) build_request();
    if (out_.refusal.empty()) build_response();
    set_first_range();
    const bool values = std::ranges::find(out_.response, FieldKind::kValue, &LearnedField::kind) !=
                        out_.response.end();
    if (out_.request.empty() && !values) refuse("no value differs");
    return std::move(out_);
  }

 private:
  void refuse(std::string reason) {
    if (out_.refusal.empty()) out_.refusal = std::move(reason);
  }

  void set_first_range() {
    const LearnedField* first = find(FieldKind::kFirst);
    if (first == nullptr) return;
    out_.lowest_first = UINT64_MAX;
    const declared::ByteTransform transform{first->add, 0};
    for (const ByteView request : group_.requests) {
      const auto at = static_cast<std::size_t>(first->at);
      const Bytes bytes = transform.meant(request.subspan(at, first->word.characters));
      const auto number = declared::read_word(bytes, first->word);
      if (!number) continue;
      out_.lowest_first = std::min(out_.lowest_first, *number);
      out_.highest_first = std::max(out_.highest_first, *number);
    }
    out_.lowest_first = std::min(out_.lowest_first, out_.highest_first);
    if (out_.highest_first > kMaxItem) refuse("the numbers of items are too large");
  }

  [[nodiscard]] LearnedField field(FieldKind kind, const Columns& columns,
                                   std::ptrdiff_t shift = 0) const {
    LearnedField made{.kind = kind, .at = columns.at + shift, .width = columns.width};
    made.word = word_at(group_.requests, columns.at, columns.width, text_);
    made.evidence = columns.evidence;
    made.note = columns.note;
    return made;
  }

  static std::ptrdiff_t head_of(const Frames& frames, const FrameEnd& end) {
    return static_cast<std::ptrdiff_t>(shortest(frames) - std::min(shortest(frames), end.size));
  }

  void build_request() {
    FieldLayout layout(group_.requests, head_of(group_.requests, request_end_), text_);
    if (request_end_.check) layout.cut(static_cast<std::ptrdiff_t>(request_end_.check->from));
    layout.add(field(FieldKind::kAddress, roles_.address));
    add_command(layout);
    layout.add(field(FieldKind::kSequence, roles_.sequence));
    response_lengths_ = find_length_fields(group_.responses, text_);
    for (const LengthField& each : known_.lengths) {
      const auto fits = [&](ByteView frame) { return each.fits(frame); };
      if (response_lengths_.empty() && std::ranges::all_of(group_.responses, fits))
        response_lengths_.push_back(each);
    }
    if (response_lengths_.empty()) guess_length();
    add_request_length(layout);
    add_count(layout);
    if (shortest(group_.requests) != longest(group_.requests))
      return refuse("requests have different lengths: a write, or several operations");
    add_first(layout);
    layout.fill(FieldKind::kUnused, "differs, unknown");
    out_.request = with_end(layout.take(), request_end_, group_.requests, request_lengths_);
  }

  void add_command(FieldLayout& layout) {
    const auto value = number_at(group_.requests.front(), roles_.command.at, command_word());
    if (roles_.command.width == 0 || !value) return;
    LearnedField made = field(FieldKind::kCommand, roles_.command);
    made.word = command_word();
    if (made.evidence.of == 0) made.evidence = {out_.exchanges, out_.exchanges};
    if (layout.add(made)) out_.command = *value;
  }
  [[nodiscard]] declared::Word command_word() const {
    return text_ ? digits(Notation::kHex, roles_.command.width) : binary(1);
  }

  // Responses of one length: a byte that is the number of bytes up to the end.
  void guess_length() {
    const std::size_t size = shortest(group_.responses), end = response_end_.size;
    if (text_ || size != longest(group_.responses) || !response_end_.check) return;
    const auto head = head_of(group_.responses, response_end_);
    for (std::ptrdiff_t at = 0; at + 1 < std::min(head, kMaxHead); ++at) {
      const LengthField guess{at,
                              binary(1),
                              1,
                              static_cast<std::size_t>(at) + 1 + end,
                              {out_.exchanges, out_.exchanges},
                              "always the same: a guess"};
      const auto fits = [&](ByteView frame) { return guess.fits(frame); };
      if (!std::ranges::all_of(group_.responses, fits)) continue;
      response_lengths_ = {guess};
      return;
    }
  }

  // A request of constant length counts in the same way as the responses.
  void add_request_length(FieldLayout& layout) {
    for (const LengthField& each : response_lengths_) {
      LengthField own = each;
      own.at -= roles_.shift;
      own.without = each.without - each.at + own.at + request_end_.size - response_end_.size;
      const auto fits = [&](ByteView frame) { return own.fits(frame); };
      if (own.at < 0 || !std::ranges::all_of(group_.requests, fits)) continue;
      own.evidence = {group_.requests.size(), group_.requests.size()};
      add_length(layout, own, request_end_.size, request_lengths_);
    }
  }

  static void add_length(FieldLayout& layout, const LengthField& length, std::size_t end_size,
                         LengthSpans& spans) {
    LearnedField made{.kind = FieldKind::kLength, .at = length.at, .word = length.word};
    made.width = length.word.characters;
    made.characters = length.unit == 1;
    made.evidence = length.evidence;
    made.note = length.note;
    const auto end = length.at + length.word.characters;
    // Characters behind the field that it does not count, and characters of the end that it does.
    const auto skipped =
        static_cast<std::ptrdiff_t>(length.without) - end - static_cast<std::ptrdiff_t>(end_size);
    if (skipped < 0) made.plus = -skipped / static_cast<std::ptrdiff_t>(length.unit);
    if (!layout.add(made)) return;
    spans.emplace_back(length.at, end + std::max<std::ptrdiff_t>(0, skipped));
    layout.cut(spans.back().second);
  }

  void add_count(FieldLayout& layout) {
    const auto free = [&](std::size_t at, std::size_t width) {
      return layout.is_free(static_cast<std::ptrdiff_t>(at), width);
    };
    rule_ = find_length_rule(group_.requests, group_.responses, text_, free,
                             known_.rule ? &*known_.rule : nullptr);
    out_.rule = rule_;
    if (!rule_ || rule_->at < 0) return;
    LearnedField made{.kind = rule_->is_last ? FieldKind::kFirst : FieldKind::kCount,
                      .at = rule_->at,
                      .width = rule_->word.characters,
                      .word = rule_->word};
    made.evidence = rule_->evidence;
    if (made.word.notation == Notation::kDecimal && made.width > 1 && rule_->highest < 10)
      made.note = "never above 9: perhaps hexadecimal";
    if (!rule_->is_last) {
      widen(layout, made);
      layout.add(made);
      return;
    }
    layout.add(made);
    made.kind = FieldKind::kLast;
    made.at += rule_->word.characters;
    layout.add(made);
  }

  // Zeros before a number belong to it.
  void widen(const FieldLayout& layout, LearnedField& number) const {
    const auto is_zero = [&](std::ptrdiff_t at) {
      return layout.is_free(at, 1) && constant_at(group_.requests, at) == (text_ ? '0' : 0);
    };
    if (text_) {
      while (number.width < 8 && is_zero(number.at - 1)) --number.at, ++number.width;
      number.word.characters = static_cast<std::uint8_t>(number.width);
    } else if (number.width == 1 && is_zero(number.at - 1)) {
      --number.at, number.width = 2, number.word = binary(2);
      number.note = "the zero before it may be a field of its own";
    } else if (number.width == 1 && is_zero(number.at + 1)) {
      number.width = 2, number.word = binary(2);
      number.note = "the zero behind it may be a field of its own";
    }
  }

  // The first run of other columns that differ.
  void add_first(FieldLayout& layout) {
    if (rule_ && rule_->is_last) return;
    const auto end = head_of(group_.requests, request_end_);
    std::ptrdiff_t at = 0;
    const auto differs = [&](std::ptrdiff_t column) {
      return layout.is_free(column, 1) && !constant_at(group_.requests, column);
    };
    while (at < end && !differs(at)) ++at;
    if (at == end) return;
    std::ptrdiff_t last = at + 1;
    while (differs(last)) ++last;
    const auto is_echo = [&](std::ptrdiff_t column) {
      return layout.is_free(column, 1) && echo_of(group_, column, first_shift_).holds_mostly();
    };
    find_first_shift(at, last);
    LearnedField made{.kind = FieldKind::kFirst};
    if (first_echoed_) {
      while (is_echo(at - 1)) --at;
      while (last < end && is_echo(last)) ++last;
    }
    if (text_) {
      const auto has_digits = [&](std::ptrdiff_t column) {
        return layout.is_free(column, 1) &&
               std::ranges::all_of(values_at(group_.requests, column), is_decimal_digit);
      };
      // Without a command, digits before it may be a part of the command.
      while (has_digits(at - 1) &&
             (roles_.command.width != 0 || constant_at(group_.requests, at - 1) == '0'))
        --at;
      while (last < end && has_digits(last)) ++last;
    }
    made.at = at;
    made.width = static_cast<std::size_t>(std::min<std::ptrdiff_t>(last - at, 8));
    made.word = word_at(group_.requests, at, made.width, text_);
    if (!text_) choose_order(layout, made);
    made.evidence = {out_.exchanges, out_.exchanges};
    if (!first_echoed_) made.note += made.note.empty() ? "no response repeats it: a guess" : "";
    layout.add(made);
  }

  void choose_order(const FieldLayout& layout, LearnedField& made) const {
    if (made.width == 1) widen(layout, made);
    const auto last = made.at + static_cast<std::ptrdiff_t>(made.width) - 1;
    made.word.little_endian = made.width > 1 && values_at(group_.requests, made.at).size() >
                                                    values_at(group_.requests, last).size();
    if (made.word.little_endian) made.note = "byte order by the byte that differs most: a guess";
  }

  // The response may repeat the item at another distance than the address.
  void find_first_shift(std::ptrdiff_t at, std::ptrdiff_t last) {
    for (std::ptrdiff_t i = 0; i <= 24; ++i) {
      const std::ptrdiff_t shift = roles_.shift + (i % 2 == 0 ? i / 2 : -(i + 1) / 2);
      bool all = true;
      for (std::ptrdiff_t column = at; column < last; ++column)
        all = all && echo_of(group_, column, shift).holds_mostly();
      if (!all) continue;
      first_echoed_ = true;
      first_shift_ = shift;
      return;
    }
  }

  void build_response() {
    const bool numbered = find(FieldKind::kFirst) != nullptr;
    auto head = head_of(group_.responses, response_end_);
    const auto end_size = static_cast<std::ptrdiff_t>(response_end_.size);
    const bool counted = rule_ && rule_->at >= 0;
    if (counted) head = static_cast<std::ptrdiff_t>(rule_->base) - end_size;
    if (head < 0) return refuse("the responses are shorter than their end");
    FieldLayout layout(group_.responses, head, text_);
    if (response_end_.check) layout.cut(static_cast<std::ptrdiff_t>(response_end_.check->from));
    if (roles_.address.echoed) add_echo(layout, FieldKind::kAddress, roles_.address);
    if (roles_.command.echoed && out_.command) {
      LearnedField made = field(FieldKind::kCommand, roles_.command, roles_.shift);
      made.word = command_word();
      made.plus = roles_.command_plus;
      layout.add(made);
    }
    if (roles_.sequence.echoed) add_echo(layout, FieldKind::kSequence, roles_.sequence);
    if (const LearnedField* first = find(FieldKind::kFirst); first != nullptr && first_echoed_) {
      LearnedField made = *first;
      made.at += first_shift_;
      layout.add(made);
    }
    for (const LengthField& each : response_lengths_)
      add_length(layout, each, response_end_.size, response_spans_);
    if (counted && !numbered)
      return refuse("all requests begin at the same item: read other items too");
    if (numbered)
      add_items(layout, head, counted);
    else
      add_values(layout, head);
  }

  void add_echo(FieldLayout& layout, FieldKind kind, const Columns& columns) {
    layout.add(field(kind, columns, roles_.shift));
  }

  [[nodiscard]] const LearnedField* find(FieldKind kind) const {
    const auto found = std::ranges::find(out_.request, kind, &LearnedField::kind);
    return found == out_.request.end() ? nullptr : &*found;
  }

  void add_items(FieldLayout& layout, std::ptrdiff_t head, bool counted) {
    LearnedField items{.kind = FieldKind::kItems, .at = head};
    items.evidence = rule_ ? rule_->evidence : Evidence{};
    if (counted) {
      layout.fill(FieldKind::kUnused, "differs, unknown");
      set_items(items, rule_->times, rule_->shared);
      out_.lowest_count = rule_->lowest;
      out_.highest_count = rule_->highest;
    } else {
      // Everything behind the known fields.
      if (shortest(group_.responses) != longest(group_.responses))
        return refuse("responses have different lengths, and no field of the request decides them");
      items.at = layout.used();
      for (const auto& [at, from] : response_spans_) items.at = std::max(items.at, from);
      const auto size = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, head - items.at));
      layout.shorten(items.at);
      layout.fill(FieldKind::kUnused, "differs, unknown");
      const std::size_t byte = text_ ? 2 : 1;
      const bool one = size == byte || size == 2 * byte || size == 4 * byte || size == 8 * byte;
      set_items(items, static_cast<unsigned>(one ? size : byte), 1);
      out_.lowest_count = out_.highest_count = one ? 1 : size / byte;
      items.note = "always of one length: items and their number are a guess";
      find_packed(items);
      if (size == 0 || size % byte != 0) return refuse("the responses have no items");
    }
    auto fields = layout.take();
    fields.push_back(items);
    out_.response = with_end(std::move(fields), response_end_, group_.responses, response_spans_);
    add_to_first(items.add);
  }

  // Packed decimal digits, if so many bytes would have other digits by chance; also if a number is
  // added to each.
  void find_packed(LearnedField& items) {
    if (text_) return;
    std::set<std::uint8_t> values;
    for (const ByteView frame : group_.responses) {
      for (std::size_t i = static_cast<std::size_t>(items.at);
           i + response_end_.size < frame.size(); ++i)
        values.insert(frame[i]);
    }
    std::vector<std::uint8_t> fits;
    for (unsigned add = 0; add < 256; ++add) {
      const auto is_packed = [&](std::uint8_t byte) {
        const auto digits = static_cast<std::uint8_t>(byte - add);
        return digits >> 4 <= 9 && (digits & 0xFu) <= 9;
      };
      if (std::ranges::all_of(values, is_packed)) fits.push_back(static_cast<std::uint8_t>(add));
    }
    if (fits.size() != 1 || values.size() < kNeededPacked) return;
    items.word.notation = Notation::kBcd;
    items.add = fits.front();
    items.note = "only decimal digits; the byte order is a guess";
  }
  // The item is in the same part of the response.
  void add_to_first(std::uint8_t add) {
    for (auto* frame : {&out_.request, &out_.response}) {
      for (LearnedField& each : *frame) {
        if (each.kind == FieldKind::kFirst && first_echoed_) each.add = add;
      }
    }
  }

  void set_items(LearnedField& items, unsigned times, unsigned shared) {
    items.bits = shared > 1;
    items.word = text_ ? digits(Notation::kHex, times) : binary(times);
    out_.item_bits = shared > 1 || (text_ && times % 2 != 0) ? 1 : times * (text_ ? 4 : 8);
    if (text_ && (times == 5 || times == 6)) {
      items.word = digits(Notation::kDecimal, times);
      out_.item_bits = 16;
    }
    if (out_.item_bits == 0 || out_.item_bits > 64) refuse("items of this width");
  }

  void add_values(FieldLayout& layout, std::ptrdiff_t head) {
    const bool same_size = shortest(group_.responses) == longest(group_.responses);
    std::vector<LearnedField> fields;
    if (text_) {
      auto used = layout.used();
      if (response_end_.check)
        used = std::max(used, static_cast<std::ptrdiff_t>(response_end_.check->from));
      auto values =
          text_values(group_.responses, static_cast<std::size_t>(used), response_end_.size);
      if (values.empty() && !same_size) return refuse("the responses have no common form");
      if (!values.empty() && values.back().variable && response_end_.size == 0)
        return refuse("nothing shows where the responses end");
      if (!values.empty()) layout.shorten(used);
      layout.fill(FieldKind::kValue, "");
      fields = layout.take();
      std::ranges::move(values, std::back_inserter(fields));
    } else if (same_size) {
      layout.fill(FieldKind::kValue, "");
      fields = layout.take();
    } else if (response_spans_.empty()) {
      return refuse("responses have different lengths, and no field decides them");
    } else {
      std::ptrdiff_t at = layout.used();
      for (const auto& [position, from] : response_spans_) at = std::max(at, from);
      while (at < head && constant_at(group_.responses, at)) ++at;
      layout.shorten(at);
      layout.fill(FieldKind::kUnused, "differs, unknown");
      fields = layout.take();
      fields.push_back(
          {.kind = FieldKind::kValue,
           .at = at,
           .text = static_cast<unsigned>(longest(group_.responses) - response_end_.size -
                                         static_cast<std::size_t>(at)),
           .variable = true,
           .evidence = {out_.exchanges, out_.exchanges},
           .note = "of different lengths: divide it into values, or into records with a key"});
    }
    out_.response = with_end(std::move(fields), response_end_, group_.responses, response_spans_);
  }

  const Group& group_;
  const Roles& roles_;
  const Known& known_;
  const bool text_;
  LearnedOperation out_;
  FrameEnd request_end_, response_end_;
  std::vector<LengthField> response_lengths_;
  // Of each length field: its position, and the first character that it counts.
  LengthSpans request_lengths_, response_spans_;
  std::optional<LengthRule> rule_;
  bool first_echoed_ = false;
  std::ptrdiff_t first_shift_ = 0;
};

}  // namespace

LearnedOperation fields_of(const Group& group, const Roles& roles, const Known& known) {
  return OperationBuilder(group, roles, known).run();
}

}  // namespace fieldcast::learn
